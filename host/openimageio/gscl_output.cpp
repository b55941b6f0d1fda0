// The writer of the OpenImageIO plug-in: collects all rows and encodes them when the file is closed.  README.md lists its
// attributes.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <vector>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/strutil.h>
#include <OpenImageIO/tiffutils.h>

#include "gscl_plugin.h"

namespace {

using OIIO::Strutil::iequals;
namespace fs = std::filesystem;

constexpr float srgb_gamma = 2.2f; // by which programs approximate the curve of sRGB

// Red, green, blue and white of sRGB, and how far others may be from them.
constexpr float srgb_primaries[8] = {0.640f, 0.330f, 0.300f, 0.600f, 0.150f, 0.060f, 0.3127f, 0.3290f};
constexpr float same_primaries = 0.002f;

// Names of profiles of sRGB.  Other names begin with them but mean something else: "sRGB-elle-V2-g10.icc" is linear.
const char *const srgb_names[] = {
    "sRGB",     "sRGB IEC61966-2.1",        "sRGB IEC61966-2-1 black scaled", "sRGB Profile",      "sRGB built-in",
    "sRGB2014", "sRGB-elle-V2-srgbtrc.icc", "sRGB-elle-V4-srgbtrc.icc",       "GIMP built-in sRGB"};

bool is_srgb(const std::string &profile) {
    return std::find(std::begin(srgb_names), std::end(srgb_names), profile) != std::end(srgb_names);
}

constexpr int max_links = 40; // one after the other, as Linux follows them

// The file that is to be replaced or made, behind all symbolic links.
fs::path behind_links(fs::path name, std::error_code &error) {
    for (int links = 0; fs::is_symlink(fs::symlink_status(name, error)); links++) {
        if (links == max_links) {
            error = std::make_error_code(std::errc::too_many_symbolic_link_levels);
            return {};
        }
        name = name.parent_path() / fs::read_symlink(name, error);
        if (error)
            return {};
    }
    error.clear(); // there need be no such file
    return name;
}

// Makes an empty file with the permissions of the one that it is to replace, before it has content.
bool make_beside(const std::string &beside, const fs::path &target) {
    std::error_code error;
    const fs::file_status status = fs::status(target, error);
    // One that may not be written is not replaced, either.
    if (fs::exists(status) && !std::ofstream(target, std::ios::app))
        return false;
    if (!std::ofstream(beside))
        return false;
    if (fs::exists(status))
        fs::permissions(beside, status.permissions() & fs::perms(0777), error);
    return true;
}

class GsclOutput final : public OIIO::ImageOutput {
  public:
    ~GsclOutput() override {
        close();
    }
    const char *format_name() const override {
        return "gscl";
    }
    int supports(OIIO::string_view feature) const override {
        return feature == "alpha" || feature == "ioproxy" || feature == "random_access" || feature == "exif";
    }
    bool open(const std::string &name, const OIIO::ImageSpec &spec, OpenMode mode) override;
    bool write_scanline(int y, int z, OIIO::TypeDesc format, const void *data, OIIO::stride_t xstride) override;
    bool close() override;

  private:
    bool check_spec();
    bool check_primaries();
    void choose_format();
    bool choose_preset();
    bool choose_number(const char *name, gscl_target target, double min, double max);
    bool choose_quality();
    bool choose_target();
    bool choose_settings();
    bool wants_metadata(const char *name) const;
    bool take_code_points(const OIIO::ParamValue &cicp);
    void add_block(gscl_block_type type, const void *data, size_t size);
    bool collect_blocks();
    void make_srgb();
    void turn_upright(gscl_image &image, OIIO::ImageBuf &upright);
    bool encode();
    bool write_file(const uint8_t *bytes, size_t size);
    bool replace_file(const fs::path &target, OIIO::cspan<uint8_t> bytes);
    template <typename... Arguments> bool fail(const char *format, const Arguments &...arguments) {
        errorfmt(format, arguments...);
        return false;
    }

    std::string name_;
    bool open_ = false;
    float gamma_ = 0; // exponent from samples to light; 0 for samples that are stored as they are
    std::vector<uint8_t> pixels_, scratch_;
    std::vector<bool> written_; // which rows have come
    gscl_encode_settings settings_;
    std::vector<char> exif_;
    std::string xmp_;
    uint8_t cicp_[2];
    gscl_block blocks_[4];
    size_t block_count_ = 0;
};

// ---- Opening --------------------------------------------------------------------------------------

bool GsclOutput::check_spec() {
    if (m_spec.width < 1 || m_spec.height < 1 || m_spec.width > GSCL_MAX_DIMENSION ||
        m_spec.height > GSCL_MAX_DIMENSION)
        return fail("a picture of {} x {} pixels cannot be written; 1 x 1 to {} x {} are possible", m_spec.width,
                    m_spec.height, GSCL_MAX_DIMENSION, GSCL_MAX_DIMENSION);
    if (m_spec.deep || m_spec.depth > 1)
        return fail("deep and volume images cannot be written; a flat one is needed");
    if (m_spec.nchannels < 1 || m_spec.nchannels > 4)
        return fail("{} channels cannot be written; grey or RGB, with or without alpha, is needed", m_spec.nchannels);
    return check_primaries();
}

// Refuses primaries without a profile: pixels would show other colours.
bool GsclOutput::check_primaries() {
    float given[8];
    if (m_spec.nchannels < 3 || m_spec.find_attribute("ICCProfile") || m_spec.find_attribute("CICP") ||
        !m_spec.getattribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), given))
        return true;
    for (int i = 0; i < 8; i++) {
        if (!(std::abs(given[i] - srgb_primaries[i]) <= same_primaries))
            return fail("the colours have other primaries than sRGB (attribute chromaticities); convert them first, or "
                        "give their profile or code points (CICP)");
    }
    return true;
}

// Chooses the samples to encode, of the kinds that gscl has.  Linear light and other gammas become sRGB, which needs floats.
void GsclOutput::choose_format() {
    const std::string space(m_spec.get_string_attribute("oiio:ColorSpace"));
    const bool linear = iequals(space, "Linear") || iequals(space, "scene_linear") || iequals(space, "lin_srgb");
    const bool has_gamma = OIIO::Strutil::istarts_with(space, "Gamma");
    gamma_ = linear ? 1.0f : has_gamma ? m_spec.get_float_attribute("oiio:Gamma", srgb_gamma) : 0.0f;
    if (m_spec.find_attribute("ICCProfile") || m_spec.find_attribute("CICP") || std::abs(gamma_ - srgb_gamma) < 0.01f)
        gamma_ = 0.0f;
    const auto type = m_spec.format.basetype;
    if (gamma_ > 0.0f)
        m_spec.set_format(OIIO::TypeDesc::FLOAT);
    else if (type == OIIO::TypeDesc::INT8)
        m_spec.set_format(OIIO::TypeDesc::UINT8);
    else if (type == OIIO::TypeDesc::INT16)
        m_spec.set_format(OIIO::TypeDesc::UINT16);
    else if (type != OIIO::TypeDesc::UINT8 && type != OIIO::TypeDesc::UINT16)
        m_spec.set_format(OIIO::TypeDesc::FLOAT);
}

// Takes a target, if it is given.
bool GsclOutput::choose_number(const char *name, gscl_target target, double min, double max) {
    const OIIO::ParamValue *given = m_spec.find_attribute(name);
    if (!given)
        return true;
    const double value = gscl_plugin::number_of(m_spec, name, NAN);
    if (!(value >= min && value <= max))
        return fail("{} cannot be {}; it takes a number from {} to {}", name, given->get_string(), min, max);
    if (settings_.target != GSCL_TARGET_AUTO || m_spec.find_attribute("gscl:preset"))
        return fail(
            "gscl:preset, gscl:bytes, gscl:bpp, gscl:psnr, gscl:ssimulacra2 and gscl:splats exclude each other; "
            "give one of them");
    settings_.target = target;
    settings_.target_value = value;
    return true;
}

// Takes the target and the effort of a preset, if it is given.
bool GsclOutput::choose_preset() {
    const std::string given(m_spec.get_string_attribute("gscl:preset"));
    std::string names;
    if (given.empty())
        return true;
    for (int i = 0; const char *name = gscl_preset_name(static_cast<gscl_preset>(i)); i++) {
        if (given == name)
            return gscl_encode_settings_preset(&settings_, static_cast<gscl_preset>(i)) == GSCL_OK;
        names += (i > 0 ? ", " : "") + std::string(name);
    }
    return fail("gscl:preset cannot be '{}'; it takes one of {}", given, names);
}

// Takes "Compression" of the form "gscl:QUALITY" and "CompressionQuality", which gscl's own attributes precede.  Those of
// the format that the picture came from have another name and are ignored.
bool GsclOutput::choose_quality() {
    const std::string compression(m_spec.get_string_attribute("Compression"));
    if (!compression.empty() && !OIIO::Strutil::istarts_with(compression, "gscl"))
        return true;
    const size_t colon = compression.find(':');
    const std::string given =
        colon != std::string::npos ? compression.substr(colon + 1) : std::string(m_spec["CompressionQuality"].get());
    const bool is_given = colon != std::string::npos || m_spec.find_attribute("CompressionQuality");
    if (settings_.target != GSCL_TARGET_AUTO || m_spec.find_attribute("gscl:preset") || !is_given)
        return true;
    const int quality = OIIO::Strutil::string_is_int(given) ? OIIO::Strutil::stoi(given) : -1;
    if (quality < 0 || quality > 100)
        return fail("a compression quality cannot be '{}'; it takes 0 to 100", given);
    settings_.target = GSCL_TARGET_QUALITY;
    settings_.target_value = quality;
    return true;
}

bool GsclOutput::choose_target() {
    return choose_number("gscl:bytes", GSCL_TARGET_BYTES, 1, UINT32_MAX) &&
           choose_number("gscl:bpp", GSCL_TARGET_BPP, 0.0001, 64) &&
           choose_number("gscl:psnr", GSCL_TARGET_PSNR, 1, 100) &&
           choose_number("gscl:ssimulacra2", GSCL_TARGET_SSIMULACRA2, GSCL_MIN_SSIMULACRA2, 100) &&
           choose_number("gscl:splats", GSCL_TARGET_SPLATS, 0, GSCL_MAX_SPLATS) && choose_quality();
}

bool GsclOutput::choose_settings() {
    static const std::map<std::string, gscl_tune> tunes{
        {"auto", GSCL_TUNE_AUTO}, {"psnr", GSCL_TUNE_PSNR}, {"ssim", GSCL_TUNE_SSIM}, {"visual", GSCL_TUNE_VISUAL}};
    const std::string tune(m_spec.get_string_attribute("gscl:tune", "auto"));
    const std::string metadata(m_spec.get_string_attribute("gscl:metadata", "none"));
    gscl_encode_settings_default(&settings_);
    if (!choose_preset())
        return false;
    settings_.effort = m_spec.get_int_attribute("gscl:effort", settings_.effort);
    settings_.progressive = m_spec.get_int_attribute("gscl:progressive") != 0;
    const auto named = tunes.find(tune);
    if (named == tunes.end())
        return fail("gscl:tune cannot be '{}'; it takes auto, psnr, ssim or visual", tune);
    settings_.tune = named->second;
    if (settings_.effort < 0 || settings_.effort > GSCL_MAX_EFFORT)
        return fail("gscl:effort cannot be {}; it takes 0 to {}", settings_.effort, GSCL_MAX_EFFORT);
    if (metadata != "none" && metadata != "exif" && metadata != "all")
        return fail("gscl:metadata cannot be '{}'; it takes none, exif or all", metadata);
    return choose_target();
}

bool GsclOutput::open(const std::string &name, const OIIO::ImageSpec &spec, OpenMode mode) {
    if (mode != Create)
        return fail("a gscl file holds one picture");
    name_ = name;
    m_spec = spec;
    ioproxy_retrieve_from_config(m_spec);
    if (!check_spec())
        return false;
    choose_format();
    if (!choose_settings())
        return false;
    pixels_.resize(m_spec.image_bytes());
    written_.assign(size_t(m_spec.height), false);
    open_ = true;
    return true;
}

bool GsclOutput::write_scanline(int y, int z, OIIO::TypeDesc format, const void *data, OIIO::stride_t xstride) {
    const int row = y - m_spec.y;
    if (!open_ || row < 0 || row >= m_spec.height)
        return fail("there is no row {} to write", y);
    const size_t size = m_spec.scanline_bytes();
    std::memcpy(pixels_.data() + size_t(row) * size, to_native_scanline(format, data, xstride, scratch_, 0, y, z),
                size);
    written_[size_t(row)] = true;
    return true;
}

// ---- What the file holds beside the picture -------------------------------------------------------

bool GsclOutput::wants_metadata(const char *name) const {
    const std::string metadata(m_spec.get_string_attribute("gscl:metadata", "none"));
    return metadata == "all" || metadata == name;
}

void GsclOutput::add_block(gscl_block_type type, const void *data, size_t size) {
    blocks_[block_count_] = {nullptr, type, data, size};
    if (block_count_ > 0)
        blocks_[block_count_ - 1].next = &blocks_[block_count_];
    block_count_++;
    settings_.blocks = blocks_;
}

// Takes colours by their code points: those of the pixels, which are RGB of the full range.
bool GsclOutput::take_code_points(const OIIO::ParamValue &cicp) {
    const size_t count = cicp.type().basetype == OIIO::TypeDesc::INT ? cicp.type().basevalues() : 0;
    const int *points = static_cast<const int *>(cicp.data());
    bool right = count == 2 || (count == 4 && points[2] == 0 && points[3] == 1);
    for (int i = 0; right && i < 2; i++) {
        right = points[i] >= 0 && points[i] <= 255;
        cicp_[i] = uint8_t(points[i]);
    }
    if (!right)
        return fail(
            "CICP cannot be {}; it takes primaries and transfer from 0 to 255, matrix 0 (RGB) and range 1 (full)",
            cicp.get_string());
    add_block(GSCL_BLOCK_COLOUR_SPACE, cicp_, sizeof cicp_);
    return true;
}

// Lists the blocks to store.  A profile of sRGB is left out: a file without one has these colours.
bool GsclOutput::collect_blocks() {
    const std::string description(m_spec.get_string_attribute("ICCProfile:profile_description"));
    const OIIO::ParamValue *icc = m_spec.find_attribute("ICCProfile");
    const OIIO::ParamValue *cicp = m_spec.find_attribute("CICP");
    block_count_ = 0;
    if (cicp && !take_code_points(*cicp))
        return false;
    if (icc && icc->type().size() > GSCL_MAX_BLOCK_SIZE)
        return fail("the colour profile has {} bytes; a gscl file holds at most {}", icc->type().size(),
                    GSCL_MAX_BLOCK_SIZE);
    if (icc && icc->type().basetype == OIIO::TypeDesc::UINT8 && !is_srgb(description))
        add_block(GSCL_BLOCK_ICC, icc->data(), icc->type().size());
    OIIO::ImageSpec spec = m_spec; // of the upright picture
    spec.attribute("Orientation", 1);
    if (wants_metadata("exif")) {
        OIIO::encode_exif(spec, exif_);
        add_block(GSCL_BLOCK_EXIF, exif_.data(), exif_.size());
    }
    if (wants_metadata("xmp")) {
        xmp_ = OIIO::encode_xmp(spec, false); // with IPTC, which gscl has no block for
        if (!xmp_.empty())
            add_block(GSCL_BLOCK_XMP, xmp_.data(), xmp_.size());
    }
    return true;
}

// ---- Encoding -------------------------------------------------------------------------------------

float linear_to_srgb(float v) {
    return v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1.0f / 2.4f) - 0.055f;
}

// Converts samples of another gamma, multiplied by alpha unless the spec says otherwise, to straight sRGB.
void GsclOutput::make_srgb() {
    const size_t channels = size_t(m_spec.nchannels), colours = channels % 2 ? channels : channels - 1;
    const bool straight = m_spec.get_int_attribute("oiio:UnassociatedAlpha") != 0;
    float *pixel = reinterpret_cast<float *>(pixels_.data());
    for (size_t left = m_spec.image_pixels(); left > 0; left--, pixel += channels) {
        const float alpha = colours == channels || straight ? 1.0f : pixel[colours];
        for (size_t c = 0; c < colours; c++)
            pixel[c] = alpha > 0.0f ? linear_to_srgb(std::pow(std::max(pixel[c] / alpha, 0.0f), gamma_)) : 0.0f;
    }
}

// Turns the picture as its attribute Orientation says.  `upright` owns the new pixels.
void GsclOutput::turn_upright(gscl_image &image, OIIO::ImageBuf &upright) {
    const int orientation = m_spec.get_int_attribute("Orientation", 1);
    if (orientation < 2 || orientation > 8)
        return;
    OIIO::ImageSpec spec(m_spec.width, m_spec.height, m_spec.nchannels, m_spec.format);
    spec.attribute("Orientation", orientation);
    OIIO::ImageBuf stored(spec, image.pixels);
    upright = OIIO::ImageBufAlgo::reorient(stored);
    image.width = uint32_t(upright.spec().width);
    image.height = uint32_t(upright.spec().height);
    image.pixels = upright.localpixels();
}

// Writes the whole file or nothing: beside the target, whose name it then takes.
bool GsclOutput::replace_file(const fs::path &target, OIIO::cspan<uint8_t> bytes) {
    const std::string beside = OIIO::Filesystem::unique_path(target.string() + ".%%%%%%%%");
    std::string reason;
    if (!make_beside(beside, target) || !OIIO::Filesystem::write_binary_file(beside, bytes))
        reason = std::strerror(errno);
    else if (OIIO::Filesystem::rename(beside, target.string(), reason))
        return true;
    OIIO::Filesystem::remove(beside);
    return fail("\"{}\" cannot be written: {}", name_, reason);
}

// Writes to the caller's proxy, or to the file; what is no regular file, as a pipe, is written as it is.
bool GsclOutput::write_file(const uint8_t *bytes, size_t size) {
    if (ioproxy())
        return ioproxy()->write(bytes, size) == size || fail("cannot be written");
    std::error_code error;
    const fs::path target = behind_links(name_, error);
    if (error)
        return fail("\"{}\" cannot be written: {}", name_, error.message());
    const OIIO::cspan<uint8_t> content(bytes, ptrdiff_t(size));
    const fs::file_status status = fs::status(target, error);
    if (!fs::exists(status) || fs::is_regular_file(status))
        return replace_file(target, content);
    return OIIO::Filesystem::write_binary_file(target.string(), content) ||
           fail("\"{}\" cannot be written: {}", name_, std::strerror(errno));
}

bool GsclOutput::encode() {
    gscl_image image = {uint32_t(m_spec.width),
                        uint32_t(m_spec.height),
                        uint32_t(m_spec.nchannels),
                        GSCL_SAMPLE_F32,
                        0,
                        m_spec.nchannels % 2 == 0 && gamma_ == 0.0f &&
                            !m_spec.get_int_attribute("oiio:UnassociatedAlpha"),
                        pixels_.data(),
                        GSCL_LAYOUT_AUTO};
    if (m_spec.format != OIIO::TypeDesc::FLOAT)
        image.sample = m_spec.format == OIIO::TypeDesc::UINT8 ? GSCL_SAMPLE_U8 : GSCL_SAMPLE_U16;
    OIIO::ImageBuf upright;
    if (gamma_ > 0.0f)
        make_srgb();
    turn_upright(image, upright);
    gscl_plugin::Context context{std::string(m_spec.get_string_attribute("gscl:device"))};
    uint8_t *bytes = nullptr;
    size_t size = 0;
    gscl_result result = context.result();
    if (result == GSCL_OK)
        result = gscl_encode(context.get(), &image, &settings_, &bytes, &size, nullptr);
    const bool ok = result == GSCL_OK ? write_file(bytes, size) : fail("{}", context.message(result));
    gscl_free(bytes);
    return ok;
}

bool GsclOutput::close() {
    bool ok = true;
    const auto missing = std::count(written_.begin(), written_.end(), false);
    if (open_ && missing > 0)
        ok = fail("{} of {} rows were not written; the file is not made", missing, m_spec.height);
    else if (open_)
        ok = collect_blocks() && encode();
    open_ = false;
    pixels_ = {};
    written_ = {};
    ioproxy_clear();
    return ok;
}

} // namespace

OIIO_PLUGIN_EXPORTS_BEGIN
OIIO_EXPORT OIIO::ImageOutput *gscl_output_imageio_create() {
    return new GsclOutput;
}
OIIO_EXPORT const char *gscl_output_extensions[] = {"gscl", nullptr};
OIIO_PLUGIN_EXPORTS_END
