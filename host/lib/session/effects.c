#include "session/effects.h"

#include <math.h>
#include <string.h>

#include "session/tunables.h"

bool gscl_effect_is_open(const gscl_effects *s, gscl_effect effect) {
    return !((s->on | s->off) & effect);
}

bool gscl_effect_is_on(const gscl_effects *s, gscl_effect effect, bool automatic) {
    return gscl_effect_is_open(s, effect) ? automatic : (s->on & effect) != 0;
}

/* Why the effects of the settings are impossible; NULL when they are possible. */
static const char *contradiction(const gscl_encode_settings *s, const gscl_image *image) {
    const bool paper = s->profile == GSCL_PROFILE_PAPER;
    const uint32_t on = s->effects_on, off = s->effects_off;
    if (on & GSCL_EFFECT_CHROMA && image->channels < 3)
        return "a grey image has no chroma";
    if (on & GSCL_EFFECT_ALPHA_CHANNEL && image->channels % 2 == 1)
        return "the image has no alpha channel";
    if (on & GSCL_EFFECT_ROTATION && off & GSCL_EFFECT_ANISOTROPY)
        return "circles have no rotation; leave anisotropy on";
    if (!paper && on & GSCL_EFFECT_ANISOTROPY && off & GSCL_EFFECT_ROTATION)
        return "the default profile's ellipses need rotation; leave it on";
    if (paper ? off & GSCL_EFFECT_CODEBOOKS : on & GSCL_EFFECT_CODEBOOKS)
        return "codebooks and the paper profile go together; choose the profile";
    if (on & GSCL_EFFECT_TEXTURE && paper)
        return "the paper profile has no texture";
    if (on & GSCL_EFFECT_TEXTURE && s->blend == GSCL_BLEND_ALPHA)
        return "texture is chosen by passes that blend alpha does without; choose another blend";
    return NULL;
}

gscl_result gscl_effects_check(gscl_context *context, const gscl_encode_settings *s, const gscl_image *image) {
    for (uint32_t effect = 1; effect < 1u << GSCL_EFFECT_COUNT; effect <<= 1)
        if (s->effects_on & s->effects_off & effect)
            return gscl_fail(context, GSCL_ERROR_CONFLICT, "%s is both switched on and switched off",
                             gscl_effect_name((gscl_effect)effect));
    if ((s->effects_on | s->effects_off) >> GSCL_EFFECT_COUNT)
        return gscl_fail(context, GSCL_ERROR_INVALID_ARGUMENT, "unknown effect");
    const char *why = contradiction(s, image);
    return why ? gscl_fail(context, GSCL_ERROR_CONFLICT, "%s", why) : GSCL_OK;
}

gscl_effects gscl_effects_of_settings(const gscl_encode_settings *s, const gscl_content *content) {
    return (gscl_effects){.on = s->effects_on,
                          .off = s->effects_off,
                          .paper = s->profile == GSCL_PROFILE_PAPER,
                          .alpha_blend = s->blend == GSCL_BLEND_ALPHA,
                          .content = *content};
}

void gscl_effect_note(gscl_effects *s, gscl_effect effect, gscl_effect_reason reason, bool on, double gain_db) {
    size_t i = 0;
    while (i < s->decision_count && s->decisions[i].effect < effect)
        i++;
    if (i == s->decision_count || s->decisions[i].effect != effect) {
        if (s->decision_count == GSCL_MAX_EFFECTS)
            return;
        memmove(&s->decisions[i + 1], &s->decisions[i], (s->decision_count - i) * sizeof s->decisions[0]);
        s->decision_count++;
    }
    s->decisions[i] = (gscl_effect_decision){effect, on, reason, gain_db};
}

void gscl_effects_set_channels(const gscl_effects *s, gsf_header *header) {
    const bool alpha = header->layout == GSF_GREY_ALPHA || header->layout == GSF_RGBA;
    header->has_chroma = header->layout >= GSF_RGB && gscl_effect_is_on(s, GSCL_EFFECT_CHROMA, s->content.chroma);
    header->has_alpha = alpha && gscl_effect_is_on(s, GSCL_EFFECT_ALPHA_CHANNEL, s->content.alpha);
}

/* Whether opacity is worth its bits: isolated objects end or fade out inside a flat background, and opacity gains up to
 * 1.6 dB.  It gains nothing where a single border divides the background from the remaining image, nor without a flat
 * background.  Deciding by probe fits took half the time of an encode and was no better than this rule. */
static bool has_isolated_objects(const gscl_effects *s, const gscl_flat_background *background) {
    return !s->paper && !s->alpha_blend &&
           gscl_background_share_of_non_flat_tiles(background) > gscl_session_tunables.min_background_share;
}

void gscl_effects_set_header(const gscl_effects *s, const gscl_flat_background *background, gsf_header *header) {
    const bool opacity = has_isolated_objects(s, background) || s->alpha_blend;
    /* Without rotation all ellipses of the default profile would be horizontal, so it has circles or rotated ellipses;
     * the paper profile has axis-aligned ellipses, too. */
    const bool rotated =
        gscl_effect_is_on(s, GSCL_EFFECT_ROTATION, true) && gscl_effect_is_on(s, GSCL_EFFECT_ANISOTROPY, true);
    const bool axis_aligned = s->paper && !gscl_effect_is_on(s, GSCL_EFFECT_ROTATION, true);
    gscl_effects_set_channels(s, header);
    header->has_opacity = gscl_effect_is_on(s, GSCL_EFFECT_OPACITY, opacity);
    header->has_rotation = gscl_effect_is_on(s, GSCL_EFFECT_ROTATION, rotated);
    header->has_anisotropy = gscl_effect_is_on(s, GSCL_EFFECT_ANISOTROPY, rotated || axis_aligned);
    header->has_texture = false;
}

static bool is_trial(const gscl_effects *s, gscl_effect effect) {
    for (size_t i = 0; i < s->decision_count; i++)
        if (s->decisions[i].effect == effect)
            return s->decisions[i].reason == GSCL_EFFECT_TRIAL;
    return false;
}

/* Notes a decision, for `reason` unless the settings made it. */
static void note_default(gscl_effects *s, gscl_effect effect, gscl_effect_reason reason, bool on) {
    if (!is_trial(s, effect))
        gscl_effect_note(s, effect, gscl_effect_is_open(s, effect) ? reason : GSCL_EFFECT_REQUESTED, on, NAN);
}

void gscl_effects_note(gscl_effects *s, const gscl_flat_background *background, const gsf_header *header) {
    const bool isolated = has_isolated_objects(s, background);
    if (header->layout >= GSF_RGB)
        note_default(s, GSCL_EFFECT_CHROMA, GSCL_EFFECT_CONTENT, header->has_chroma);
    if (header->layout == GSF_GREY_ALPHA || header->layout == GSF_RGBA)
        note_default(s, GSCL_EFFECT_ALPHA_CHANNEL, GSCL_EFFECT_CONTENT, header->has_alpha);
    note_default(s, GSCL_EFFECT_OPACITY, isolated ? GSCL_EFFECT_CONTENT : GSCL_EFFECT_PROFILE, header->has_opacity);
    note_default(s, GSCL_EFFECT_ROTATION, GSCL_EFFECT_PROFILE, header->has_rotation);
    note_default(s, GSCL_EFFECT_ANISOTROPY, GSCL_EFFECT_PROFILE, header->has_anisotropy);
    note_default(s, GSCL_EFFECT_CODEBOOKS, GSCL_EFFECT_PROFILE, gscl_effect_is_on(s, GSCL_EFFECT_CODEBOOKS, s->paper));
    if (!s->paper && !s->alpha_blend)
        note_default(s, GSCL_EFFECT_TEXTURE, GSCL_EFFECT_PASSES, gscl_effect_is_on(s, GSCL_EFFECT_TEXTURE, true));
}
