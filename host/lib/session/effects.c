#include "session/effects.h"

#include <math.h>

#include "decode/coded_image.h"

#define LEAST_GROUND_BETWEEN 0.1 /* of busy tiles: about what one straight border through a small picture leaves */

bool gscl_effect_is_open(const gscl_encode_settings *s, gscl_effect effect) {
    return !((s->effects_on | s->effects_off) & effect);
}

bool gscl_effect_wanted(const gscl_encode_settings *s, gscl_effect effect, bool automatic) {
    return gscl_effect_is_open(s, effect) ? automatic : (s->effects_on & effect) != 0;
}

/* Effects that the settings ask for and that cannot be, with the reason; NULL when there is none. */
static const char *contradiction(const gscl_encode_settings *s, const gscl_image *image) {
    bool paper = s->profile == GSCL_PROFILE_PAPER;
    uint32_t on = s->effects_on, off = s->effects_off;
    if (on & GSCL_EFFECT_CHROMA && image->channels < 3)
        return "a grey image has no chroma";
    if (on & GSCL_EFFECT_ALPHA_CHANNEL && image->channels % 2 == 1)
        return "the image has no alpha channel";
    if (on & GSCL_EFFECT_ROTATION && off & GSCL_EFFECT_ANISOTROPY)
        return "circles have no rotation; leave anisotropy on";
    if (!paper && on & GSCL_EFFECT_ANISOTROPY && off & GSCL_EFFECT_ROTATION)
        return "the default profile's ellipses need rotation; leave it on";
    if (paper ? off & GSCL_EFFECT_CODEBOOKS : on & GSCL_EFFECT_CODEBOOKS)
        return "codebooks are the paper profile; choose the profile";
    if (on & GSCL_EFFECT_TEXTURE && paper)
        return "the paper profile has no texture";
    if (on & GSCL_EFFECT_TEXTURE && s->blend == GSCL_BLEND_ALPHA)
        return "texture is chosen by passes that blend alpha does without; choose another blend";
    return NULL;
}

gscl_result gscl_effects_check(const gscl_encoder *e) {
    const gscl_encode_settings *s = &e->settings;
    for (uint32_t effect = 1; effect < 1u << GSCL_EFFECT_COUNT; effect <<= 1)
        if (s->effects_on & s->effects_off & effect)
            return gscl_fail(e->context, GSCL_ERROR_CONFLICT, "%s is both asked for and ruled out",
                             gscl_effect_name((gscl_effect)effect));
    if ((s->effects_on | s->effects_off) >> GSCL_EFFECT_COUNT)
        return gscl_fail(e->context, GSCL_ERROR_INVALID_ARGUMENT, "an effect is not one that there is");
    const char *why = contradiction(s, e->image);
    return why ? gscl_fail(e->context, GSCL_ERROR_CONFLICT, "%s", why) : GSCL_OK;
}

void gscl_effect_decide(gscl_encoder *e, gscl_effect effect, gscl_effect_reason reason, bool on, double gain_db) {
    size_t i = 0;
    while (i < e->decision_count && e->decisions[i].effect != effect)
        i++;
    if (i == GSCL_MAX_EFFECTS)
        return;
    e->decision_count += i == e->decision_count;
    e->decisions[i] = (gscl_effect_decision){effect, on, reason, gain_db};
}

static bool was_tried(const gscl_encoder *e, gscl_effect effect) {
    for (size_t i = 0; i < e->decision_count; i++)
        if (e->decisions[i].effect == effect)
            return e->decisions[i].reason == GSCL_EFFECT_TRIAL;
    return false;
}

/* Notes what is known before the fit; returns whether the effect is on. */
static bool begin_with(gscl_encoder *e, gscl_effect effect, gscl_effect_reason reason, bool automatic) {
    bool on = gscl_effect_wanted(&e->settings, effect, automatic);
    if (!gscl_effect_is_open(&e->settings, effect))
        reason = GSCL_EFFECT_ASKED;
    if (!was_tried(e, effect))
        gscl_effect_decide(e, effect, reason, on, NAN);
    return on;
}

void gscl_effects_begin(gscl_encoder *e) {
    gsf_header *header = &e->coded.file.header;
    bool paper = e->settings.profile == GSCL_PROFILE_PAPER, turned;
    bool upright = paper && !gscl_effect_wanted(&e->settings, GSCL_EFFECT_ROTATION, true);
    if (header->layout >= GSF_RGB)
        header->has_chroma = begin_with(e, GSCL_EFFECT_CHROMA, GSCL_EFFECT_CONTENT, e->content.chroma);
    if (header->layout == GSF_GREY_ALPHA || header->layout == GSF_RGBA)
        header->has_alpha = begin_with(e, GSCL_EFFECT_ALPHA_CHANNEL, GSCL_EFFECT_CONTENT, e->content.alpha);
    /* Where things lie on a plain ground they end or fade out, and opacity gains up to 1.6 dB; beside a ground it gains
     * nothing, nor elsewhere.  Trials of it chose no better than this, at half the time of an encode. */
    bool alpha = e->settings.blend == GSCL_BLEND_ALPHA;
    bool things =
        !paper && !alpha && gscl_background_share_of_non_flat_tiles(&e->source.background) > LEAST_GROUND_BETWEEN;
    header->has_opacity =
        begin_with(e, GSCL_EFFECT_OPACITY, things ? GSCL_EFFECT_CONTENT : GSCL_EFFECT_PROFILE, things || alpha);
    /* Without rotation the default profile's ellipses would all lie flat: there it is circles or everything. */
    turned = gscl_effect_wanted(&e->settings, GSCL_EFFECT_ROTATION, true) &&
             gscl_effect_wanted(&e->settings, GSCL_EFFECT_ANISOTROPY, true);
    header->has_rotation = begin_with(e, GSCL_EFFECT_ROTATION, GSCL_EFFECT_PROFILE, turned);
    header->has_anisotropy = begin_with(e, GSCL_EFFECT_ANISOTROPY, GSCL_EFFECT_PROFILE, turned || upright);
    begin_with(e, GSCL_EFFECT_CODEBOOKS, GSCL_EFFECT_PROFILE, paper);
    if (!paper && e->settings.blend != GSCL_BLEND_ALPHA)
        begin_with(e, GSCL_EFFECT_TEXTURE, GSCL_EFFECT_PASSES, true);
    header->has_texture = false; /* until the passes find some */
}
