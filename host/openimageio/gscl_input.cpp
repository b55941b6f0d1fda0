// The reader of the OpenImageIO plug-in.  README.md lists its attributes.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/tiffutils.h>

#include "gscl_plugin.h"

namespace {

const uint8_t magic[] = {0xC7, 'g', 's', 'c'};

// Largest file that is read, bytes: a file of the largest number of splats with its blocks has less.
constexpr size_t max_file_bytes = size_t(256) << 20;
// Default of gscl:max_work: minutes of one core, and a thousand times what a photograph of 24 megapixels needs.
constexpr uint64_t default_max_work = 100000000000;
// Rows are decoded in bands of about so many pixels, so that a part of a huge picture needs little memory.
constexpr uint64_t band_pixels = uint64_t(1) << 23;
constexpr int thumbnail_side = 256;  // longest side of a thumbnail, pixels
constexpr size_t min_exif_bytes = 8; // the header of TIFF, which OpenImageIO reads unchecked

class GsclInput final : public OIIO::ImageInput {
  public:
    GsclInput() : context_(GSCL_HOST_DEVICE) {
    }
    ~GsclInput() override {
        close();
    }
    const char *format_name() const override {
        return "gscl";
    }
    int supports(OIIO::string_view feature) const override {
        return feature == "ioproxy" || feature == "thumbnail" || feature == "exif";
    }
    bool valid_file(const std::string &name) const override {
        uint8_t start[sizeof magic];
        return OIIO::Filesystem::read_bytes(name, start, sizeof start) == sizeof start &&
               std::memcmp(start, magic, sizeof magic) == 0;
    }
    bool open(const std::string &name, OIIO::ImageSpec &spec) override {
        return open(name, spec, OIIO::ImageSpec());
    }
    bool open(const std::string &name, OIIO::ImageSpec &spec, const OIIO::ImageSpec &config) override;
    bool close() override;
    bool read_native_scanline(int subimage, int miplevel, int y, int z, void *data) override;
    bool get_thumbnail(OIIO::ImageBuf &thumbnail, int subimage) override;

  private:
    void reset();
    bool read_file(const std::string &name);
    bool choose_sample(const std::string &name);
    bool settle_limit(const OIIO::ImageSpec &config, const char *name, uint64_t otherwise, uint64_t &limit);
    bool settle_hints(const OIIO::ImageSpec &config);
    bool make_spec(const OIIO::ImageSpec &config);
    bool check_size();
    bool check_work();
    void add_blocks();
    bool decode(const gscl_decode_settings &settings, gscl_image &image);
    bool decode_band(int y);
    bool fail(gscl_result result) {
        errorfmt("{}", context_.message(result));
        return false;
    }

    gscl_plugin::Context context_;
    std::vector<uint8_t> bytes_; // of the file
    gscl_info info_;
    gscl_decode_settings settings_; // of the whole picture
    std::vector<uint8_t> band_;     // rows band_y_ to band_y_ + band_rows_ - 1
    int band_y_ = 0, band_rows_ = 0;
};

// ---- Opening --------------------------------------------------------------------------------------

bool GsclInput::read_file(const std::string &name) {
    if (!ioproxy_use_or_open(name))
        return false;
    const size_t size = ioproxy()->size();
    bytes_.resize(std::min(size, sizeof magic));
    ioseek(0);
    if (!bytes_.empty() && !ioread(bytes_.data(), bytes_.size()))
        return false;
    if (bytes_.size() < sizeof magic || std::memcmp(bytes_.data(), magic, sizeof magic) != 0)
        return fail(GSCL_ERROR_NOT_GSCL);
    if (size > max_file_bytes) {
        errorfmt("the file has {} bytes; at most {} are read", size, max_file_bytes);
        return false;
    }
    bytes_.resize(size);
    return size == sizeof magic || ioread(bytes_.data() + sizeof magic, size - sizeof magic);
}

// The length of the other side in the same aspect ratio.
uint32_t in_ratio(uint32_t length, uint32_t full, uint32_t other_full) {
    const double other = std::floor(double(length) * other_full / full + 0.5);
    return uint32_t(std::clamp(other, 1.0, double(GSCL_MAX_DIMENSION)));
}

// The sample type of the picture: that of the hint, or that of the source.
bool GsclInput::choose_sample(const std::string &name) {
    for (gscl_sample sample : {GSCL_SAMPLE_U8, GSCL_SAMPLE_U16, GSCL_SAMPLE_F32}) {
        if (name.empty() ? sample == info_.sample : name == gscl_plugin::type_of(sample).c_str()) {
            settings_.sample = sample;
            return true;
        }
    }
    errorfmt("gscl:samples cannot be '{}'; it takes uint8, uint16 or float", name);
    return false;
}

// Takes a limit of the caller, at least 1; one that is larger than any picture needs is none.
bool GsclInput::settle_limit(const OIIO::ImageSpec &config, const char *name, uint64_t otherwise, uint64_t &limit) {
    const OIIO::ParamValue *given = config.find_attribute(name);
    const double value = given ? gscl_plugin::number_of(config, name, -1) : double(otherwise);
    if (given && !(value >= 1)) {
        errorfmt("{} cannot be {}; it takes a number from 1", name, given->get_string());
        return false;
    }
    limit = value < 1e18 ? uint64_t(value) : 0;
    return true;
}

// Takes the hints of the caller about size, samples and limits.
bool GsclInput::settle_hints(const OIIO::ImageSpec &config) {
    const int width = config.get_int_attribute("gscl:width"), height = config.get_int_attribute("gscl:height");
    if (width < 0 || height < 0 || width > GSCL_MAX_DIMENSION || height > GSCL_MAX_DIMENSION) {
        errorfmt("gscl:width and gscl:height take 1 to {}", GSCL_MAX_DIMENSION);
        return false;
    }
    settings_.width = width ? width : height ? in_ratio(height, info_.height, info_.width) : info_.width;
    settings_.height = height ? height : width ? in_ratio(width, info_.width, info_.height) : info_.height;
    if (!choose_sample(std::string(config.get_string_attribute("gscl:samples"))))
        return false;
    settings_.partial = config.get_int_attribute("gscl:partial") != 0;
    settings_.premultiplied = config.get_int_attribute("oiio:UnassociatedAlpha") == 0;
    return settle_limit(config, "gscl:max_pixels", 0, settings_.max_pixels) &&
           settle_limit(config, "gscl:max_work", default_max_work, settings_.max_work);
}

// Refuses a picture above the limits of the caller and of OpenImageIO, before anything is allocated.
bool GsclInput::check_size() {
    const uint64_t pixels = uint64_t(settings_.width) * settings_.height;
    if (settings_.max_pixels && pixels > settings_.max_pixels) {
        errorfmt("the picture has {} x {} pixels, and at most {} are allowed", settings_.width, settings_.height,
                 settings_.max_pixels);
        return false;
    }
    const uint64_t limit = uint64_t(std::max(OIIO::get_int_attribute("limits:imagesize_MB"), 0)) << 20;
    if (limit && m_spec.image_bytes(true) > limit) {
        errorfmt("the picture has {} x {} pixels, which take {} MiB, and limits:imagesize_MB is {}", settings_.width,
                 settings_.height, m_spec.image_bytes(true) >> 20, limit >> 20);
        return false;
    }
    return true;
}

// Refuses a picture whose bands together take more work than the caller allows.  Files that pass by the bound of the
// header, as photographs do, are not read for it.
bool GsclInput::check_work() {
    const double scale = double(settings_.width) * settings_.height / (double(info_.width) * info_.height);
    const double limit = double(settings_.max_work);
    if (!settings_.max_work || settings_.partial || info_.work * scale <= limit)
        return true;
    gscl_info whole = {};
    whole.struct_size = sizeof whole;
    const gscl_result result = gscl_inspect(bytes_.data(), bytes_.size(), nullptr, &whole);
    if (result != GSCL_OK)
        return fail(result);
    const double work = std::max(whole.work * scale, double(whole.splats)); // at least 1 for each splat
    if (work <= limit)
        return true;
    errorfmt("drawing the picture takes about {} evaluations; gscl:max_work is {}", uint64_t(work), settings_.max_work);
    return false;
}

bool GsclInput::make_spec(const OIIO::ImageSpec &config) {
    info_ = {};
    info_.struct_size = sizeof info_;
    const gscl_result result = gscl_probe(bytes_.data(), bytes_.size(), nullptr, &info_);
    if (result != GSCL_OK)
        return fail(result);
    gscl_decode_settings_default(&settings_);
    if (!settle_hints(config))
        return false;
    m_spec = OIIO::ImageSpec(int(settings_.width), int(settings_.height), int(info_.channels),
                             gscl_plugin::type_of(settings_.sample));
    gscl_plugin::name_channels(m_spec);
    if (!settings_.premultiplied && m_spec.alpha_channel >= 0)
        m_spec.attribute("oiio:UnassociatedAlpha", 1);
    // A prefix has no end to look for blocks behind it, and a damaged one must not fail before its pixels do.
    if (!settings_.partial)
        add_blocks();
    m_spec.attribute("gscl:splat_count", int(info_.splats));
    m_spec.attribute("gscl:file_bytes", int(info_.bytes));
    const uint32_t longest = std::max(settings_.width, settings_.height);
    const double scale = std::min(1.0, double(thumbnail_side) / longest);
    m_spec.attribute("thumbnail_width", std::max(1, int(settings_.width * scale + 0.5)));
    m_spec.attribute("thumbnail_height", std::max(1, int(settings_.height * scale + 0.5)));
    m_spec.attribute("thumbnail_nchannels", int(info_.channels));
    return check_size() && check_work();
}

// Adds what the file holds beside the picture.
void GsclInput::add_blocks() {
    struct {
        const uint8_t *data;
        size_t size;
    } blocks[4] = {};
    for (int type = GSCL_BLOCK_COLOUR_SPACE; type <= GSCL_BLOCK_XMP; type++) {
        const void *data = nullptr;
        if (gscl_find_block(bytes_.data(), bytes_.size(), gscl_block_type(type), &data, &blocks[type].size) == GSCL_OK)
            blocks[type].data = static_cast<const uint8_t *>(data);
    }
    const auto &exif = blocks[GSCL_BLOCK_EXIF], &xmp = blocks[GSCL_BLOCK_XMP], &icc = blocks[GSCL_BLOCK_ICC],
               &cicp = blocks[GSCL_BLOCK_COLOUR_SPACE];
    if (exif.size >= min_exif_bytes)
        OIIO::decode_exif(OIIO::cspan<uint8_t>(exif.data, OIIO::cspan<uint8_t>::size_type(exif.size)), m_spec);
    if (xmp.data)
        OIIO::decode_xmp(OIIO::string_view(reinterpret_cast<const char *>(xmp.data), xmp.size), m_spec);
    if (exif.data || xmp.data)
        m_spec.attribute("Orientation", 1); // pictures of gscl are upright
    if (icc.data)
        m_spec.attribute("ICCProfile", OIIO::TypeDesc(OIIO::TypeDesc::UINT8, int(icc.size)), icc.data);
    if (cicp.data && cicp.size == 2) {
        const int code_points[4] = {cicp.data[0], cicp.data[1], 0, 1}; // RGB, full range
        m_spec.attribute("CICP", OIIO::TypeDesc(OIIO::TypeDesc::INT, 4), code_points);
    }
    if (!icc.data && !cicp.data)
        m_spec.attribute("oiio:ColorSpace", "sRGB");
}

bool GsclInput::open(const std::string &name, OIIO::ImageSpec &spec, const OIIO::ImageSpec &config) {
    reset(); // and not close(), which would forget a proxy that is already set
    ioproxy_retrieve_from_config(config);
    if (context_.result() != GSCL_OK)
        return fail(context_.result());
    if (!read_file(name) || !make_spec(config)) {
        close();
        return false;
    }
    spec = m_spec;
    return true;
}

void GsclInput::reset() {
    bytes_ = {};
    band_ = {};
    band_y_ = band_rows_ = 0;
}

bool GsclInput::close() {
    reset();
    ioproxy_clear();
    return true;
}

// ---- Pixels ---------------------------------------------------------------------------------------

bool GsclInput::decode(const gscl_decode_settings &settings, gscl_image &image) {
    const gscl_result result = gscl_decode(context_.get(), bytes_.data(), bytes_.size(), &settings, &image);
    return result == GSCL_OK || fail(result);
}

// Decodes the rows around row y.
bool GsclInput::decode_band(int y) {
    const uint32_t rows = uint32_t(std::clamp<uint64_t>(band_pixels / settings_.width, 1, settings_.height));
    gscl_decode_settings settings = settings_;
    settings.crop_y = uint32_t(y) / rows * rows;
    settings.crop_width = settings.width;
    settings.crop_height = std::min(rows, settings.height - settings.crop_y);
    if (settings.partial && settings.max_work) // check_work knows that of a whole file only
        settings.max_work =
            std::max<uint64_t>(uint64_t(double(settings.max_work) * settings.crop_height / settings.height), 1);
    band_rows_ = 0;
    band_.resize(m_spec.scanline_bytes(true) * settings.crop_height);
    gscl_image image = {settings.width,         settings.crop_height, info_.channels,  settings.sample, 0,
                        settings.premultiplied, band_.data(),         GSCL_LAYOUT_AUTO};
    if (!decode(settings, image))
        return false;
    band_y_ = int(settings.crop_y);
    band_rows_ = int(settings.crop_height);
    return true;
}

bool GsclInput::read_native_scanline(int subimage, int miplevel, int y, int, void *data) {
    lock_guard lock(*this);
    if (!seek_subimage(subimage, miplevel))
        return false;
    if (bytes_.empty() || y < 0 || y >= m_spec.height) {
        errorfmt("there is no row {}", y);
        return false;
    }
    if ((y < band_y_ || y >= band_y_ + band_rows_) && !decode_band(y))
        return false;
    const size_t row = m_spec.scanline_bytes(true);
    std::memcpy(data, band_.data() + size_t(y - band_y_) * row, row);
    return true;
}

bool GsclInput::get_thumbnail(OIIO::ImageBuf &thumbnail, int subimage) {
    lock_guard lock(*this);
    if (!seek_subimage(subimage, 0) || bytes_.empty())
        return false;
    gscl_decode_settings settings = settings_;
    settings.width = uint32_t(m_spec.get_int_attribute("thumbnail_width"));
    settings.height = uint32_t(m_spec.get_int_attribute("thumbnail_height"));
    settings.sample = GSCL_SAMPLE_U8;
    gscl_image image = {};
    if (!decode(settings, image))
        return false;
    OIIO::ImageSpec spec(int(image.width), int(image.height), int(image.channels), OIIO::TypeDesc::UINT8);
    gscl_plugin::name_channels(spec);
    thumbnail.reset(spec);
    thumbnail.set_pixels(OIIO::get_roi(spec), OIIO::TypeDesc::UINT8, image.pixels);
    gscl_free(image.pixels);
    return true;
}

} // namespace

OIIO_PLUGIN_EXPORTS_BEGIN
OIIO_EXPORT int gscl_imageio_version = OIIO_PLUGIN_VERSION;
OIIO_EXPORT const char *gscl_imageio_library_version() {
    return "gscl " GSCL_VERSION;
}
OIIO_EXPORT OIIO::ImageInput *gscl_input_imageio_create() {
    return new GsclInput;
}
OIIO_EXPORT const char *gscl_input_extensions[] = {"gscl", nullptr};
OIIO_PLUGIN_EXPORTS_END
