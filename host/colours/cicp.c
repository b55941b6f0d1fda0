#include "colours/cicp.h"

#include <stddef.h>

#define WHITE_C 0.310, 0.316
#define WHITE_D65 0.3127, 0.3290
#define WHITE_DCI 0.314, 0.351
#define WHITE_E (1.0 / 3.0), (1.0 / 3.0)

typedef struct primaries_row {
    uint8_t code;
    double xy[8];
} primaries_row;

static const primaries_row primaries[] = {
    {1, {WHITE_D65, 0.640, 0.330, 0.300, 0.600, 0.150, 0.060}},  /* BT.709, sRGB */
    {2, {WHITE_D65, 0.640, 0.330, 0.300, 0.600, 0.150, 0.060}},  /* unspecified */
    {4, {WHITE_C, 0.670, 0.330, 0.210, 0.710, 0.140, 0.080}},    /* BT.470 M */
    {5, {WHITE_D65, 0.640, 0.330, 0.290, 0.600, 0.150, 0.060}},  /* BT.601, 625 lines */
    {6, {WHITE_D65, 0.630, 0.340, 0.310, 0.595, 0.155, 0.070}},  /* BT.601, 525 lines */
    {7, {WHITE_D65, 0.630, 0.340, 0.310, 0.595, 0.155, 0.070}},  /* SMPTE 240M */
    {8, {WHITE_C, 0.681, 0.319, 0.243, 0.692, 0.145, 0.049}},    /* film */
    {9, {WHITE_D65, 0.708, 0.292, 0.170, 0.797, 0.131, 0.046}},  /* BT.2020 */
    {10, {WHITE_E, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0}},               /* XYZ */
    {11, {WHITE_DCI, 0.680, 0.320, 0.265, 0.690, 0.150, 0.060}}, /* DCI-P3 */
    {12, {WHITE_D65, 0.680, 0.320, 0.265, 0.690, 0.150, 0.060}}, /* Display P3 */
    {22, {WHITE_D65, 0.630, 0.340, 0.295, 0.605, 0.155, 0.077}}, /* EBU 3213 */
};

const double *cicp_primaries(uint8_t code) {
    for (size_t i = 0; i < sizeof primaries / sizeof *primaries; i++) {
        if (primaries[i].code == code)
            return primaries[i].xy;
    }
    return NULL;
}

cmsToneCurve *cicp_curve(cmsContext context, uint8_t code) {
    /* Parameters of type 4 of ICC: exponent, a, b, c, d. */
    static const double srgb[] = {2.4, 1 / 1.055, 0.055 / 1.055, 1 / 12.92, 0.04045};
    switch (code) {
    case 1:
    case CICP_UNSPECIFIED:
    case 6:
    case CICP_TRANSFER_SRGB:
    case 14:
    case 15:
        return cmsBuildParametricToneCurve(context, 4, srgb);
    case 4:
        return cmsBuildGamma(context, 2.2);
    case 5:
        return cmsBuildGamma(context, 2.8);
    case 8:
        return cmsBuildGamma(context, 1.0);
    default:
        return NULL;
    }
}

cmsHPROFILE profile_of_primaries(cmsContext context, const double xy[8], cmsToneCurve *curve, unsigned channels) {
    if (!curve)
        return NULL;
    cmsHPROFILE profile;
    if (channels == 1) {
        profile = cmsCreateGrayProfileTHR(context, cmsD50_xyY(), curve);
    } else {
        const cmsCIExyY white = {xy[0], xy[1], 1.0};
        const cmsCIExyYTRIPLE colours = {{xy[2], xy[3], 1.0}, {xy[4], xy[5], 1.0}, {xy[6], xy[7], 1.0}};
        cmsToneCurve *const curves[3] = {curve, curve, curve};
        profile = cmsCreateRGBProfileTHR(context, &white, &colours, curves);
    }
    cmsFreeToneCurve(curve);
    return profile;
}

cmsHPROFILE profile_of_cicp(cmsContext context, const uint8_t cicp[2], unsigned channels) {
    const double *xy = cicp_primaries(cicp[0]);
    return xy ? profile_of_primaries(context, xy, cicp_curve(context, cicp[1]), channels) : NULL;
}

bool cicp_is_hdr(const uint8_t cicp[2]) {
    return cicp[1] == CICP_TRANSFER_PQ || cicp[1] == CICP_TRANSFER_HLG;
}

const char *cicp_name(const uint8_t cicp[2]) {
    const bool srgb_curve = cicp[1] == CICP_TRANSFER_SRGB;
    if (cicp[0] == CICP_PRIMARIES_SRGB && srgb_curve)
        return "sRGB";
    if (cicp[0] == 12 && srgb_curve)
        return "Display P3";
    if (cicp[0] == 9)
        return cicp[1] == CICP_TRANSFER_PQ ? "BT.2020 PQ" : cicp[1] == CICP_TRANSFER_HLG ? "BT.2020 HLG" : "BT.2020";
    return "code points of H.273";
}
