// The image module: OpenImageIO and OpenJPEG behind the functions of image_module.h.
#include "image/image_module.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <OpenImageIO/strutil.h>

#include "image/image_jpeg2000.h"
#include "image/image_samples.h"

namespace {

bool fail(char *message, const std::string &text) {
    std::snprintf(message, IMAGE_MESSAGE_SIZE, "%s", text.c_str());
    return false;
}

// The error text of OpenImageIO, which may be empty.
std::string reason(const std::string &text) {
    return text.empty() ? "the file is truncated or damaged" : text;
}

// ---- Kinds of pixels ------------------------------------------------------------------------------

OIIO::TypeDesc type_of(gscl_sample sample) {
    return sample == GSCL_SAMPLE_U8    ? OIIO::TypeDesc::UINT8
           : sample == GSCL_SAMPLE_U16 ? OIIO::TypeDesc::UINT16
                                       : OIIO::TypeDesc::FLOAT;
}

bool holds_linear_light(const OIIO::ImageSpec &spec) {
    return OIIO::Strutil::iequals(spec.get_string_attribute("oiio:ColorSpace"), "Linear");
}

// The narrowest sample type of gscl that holds the samples of the file.
gscl_sample sample_for(const OIIO::ImageSpec &spec) {
    if (holds_linear_light(spec)) // has a larger range, and is converted
        return GSCL_SAMPLE_F32;
    switch (spec.format.basetype) {
    case OIIO::TypeDesc::UINT8:
        return GSCL_SAMPLE_U8;
    case OIIO::TypeDesc::UINT16:
        return GSCL_SAMPLE_U16;
    default: // also signed integers, whose negative samples are counted as clamped
        return GSCL_SAMPLE_F32;
    }
}

bool channel_is(const OIIO::ImageSpec &spec, int channel, const char *name) {
    return OIIO::Strutil::iequals(spec.channelnames[channel], name);
}

// Some plug-ins do not mark the alpha channel of their spec.
bool is_alpha(const OIIO::ImageSpec &spec, int channel) {
    return spec.alpha_channel == channel || channel_is(spec, channel, "A");
}

// Whether a file has alpha for each colour, as OpenEXR may.
bool has_alpha_for_each_colour(const OIIO::ImageSpec &spec) {
    return std::any_of(spec.channelnames.begin(), spec.channelnames.end(),
                       [](const std::string &name) { return name == "AR" || name == "AG" || name == "AB"; });
}

// The number of leading channels that form an image: 1 grey, 2 grey and alpha, 3 RGB, 4 RGBA; 0 if the channels have
// other meanings.  In OpenEXR others (depth, layers) may follow.
int image_channels(const OIIO::ImageSpec &spec) {
    if (spec.nchannels == 1)
        return 1;
    if (spec.nchannels == 2)
        return is_alpha(spec, 1) ? 2 : 0;
    if (!channel_is(spec, 0, "R") || !channel_is(spec, 1, "G") || !channel_is(spec, 2, "B"))
        return 0;
    if (spec.nchannels == 3)
        return 3;
    if (is_alpha(spec, 3))
        return 4;
    return holds_linear_light(spec) && !has_alpha_for_each_colour(spec) ? 3 : 0;
}

// The name of a colour space that OpenImageIO does not convert correctly; empty for RGB and grey.
std::string foreign_colours(const OIIO::ImageSpec &spec) {
    for (const char *attribute : {"tiff:ColorSpace", "jpeg:ColorSpace"}) {
        const std::string colours(spec.get_string_attribute(attribute));
        for (const char *name : {"CMYK", "YCCK", "CIELAB", "ICCLAB", "ITULAB"}) {
            if (colours == name)
                return colours;
        }
    }
    return "";
}

// ---- Colour ---------------------------------------------------------------------------------------

float linear_to_srgb(float v) {
    return v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1.0f / 2.4f) - 0.055f;
}

float srgb_to_linear(float v) {
    return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
}

// Calls change(colour, alpha) for each colour sample of an F32 image; alpha is 1 where there is none.
template <typename Change> void change_colours(const gscl_image &image, Change change) {
    const bool has_alpha = image.channels % 2 == 0;
    const size_t colours = has_alpha ? image.channels - 1 : image.channels;
    float *pixel = static_cast<float *>(image.pixels);
    for (size_t left = size_t(image.width) * image.height; left > 0; left--, pixel += image.channels) {
        for (size_t c = 0; c < colours; c++)
            pixel[c] = change(pixel[c], has_alpha ? pixel[colours] : 1.0f);
    }
}

// From linear light multiplied by alpha, as OpenEXR has it.
void to_straight_srgb(const gscl_image &image) {
    change_colours(image, [](float v, float a) { return linear_to_srgb(a > 0.0f ? v / a : a == 0.0f ? 0.0f : v); });
}

void to_premultiplied_linear(const gscl_image &image) {
    change_colours(image, [](float v, float a) { return srgb_to_linear(v) * a; });
}

// ---- Reading --------------------------------------------------------------------------------------

// Whether the module gives four channels of inks, as it was asked to.
bool holds_inks(const OIIO::ImageSpec &spec) {
    return spec.nchannels == 4 && OIIO::Strutil::iequals(spec.get_string_attribute("oiio:ColorSpace"), "CMYK");
}

// A rectangle of pixels.
struct window {
    int x, y, width, height;
};

window data_window(const OIIO::ImageSpec &spec) {
    return {spec.x, spec.y, spec.width, spec.height};
}

// The pixels that the file shows.  OpenEXR may hold less, which is black and clear, or more, which is cut off.
window shown_window(const OIIO::ImageInput &input) {
    const OIIO::ImageSpec &spec = input.spec();
    if (std::strcmp(input.format_name(), "openexr") != 0)
        return data_window(spec);
    return {spec.full_x, spec.full_y, spec.full_width, spec.full_height};
}

bool is_same(const window &a, const window &b) {
    return a.x == b.x && a.y == b.y && a.width == b.width && a.height == b.height;
}

bool check_size(const window &pixels, char *message) {
    if (pixels.width >= 1 && pixels.height >= 1 && pixels.width <= GSCL_MAX_DIMENSION &&
        pixels.height <= GSCL_MAX_DIMENSION)
        return true;
    std::snprintf(message, IMAGE_MESSAGE_SIZE, IMAGE_SIZE_MESSAGE, unsigned(pixels.width), unsigned(pixels.height));
    return false;
}

// Checks that need no decoded pixels.
bool check_spec(const OIIO::ImageInput &input, char *message) {
    const OIIO::ImageSpec &spec = input.spec();
    if (!check_size(data_window(spec), message) || !check_size(shown_window(input), message))
        return false;
    if (spec.deep || spec.depth > 1)
        return fail(message, "is a deep or volume image; a flat one is needed");
    if (holds_linear_light(spec) && spec.format == OIIO::TypeDesc::UINT32)
        return fail(message, "holds integers, which have no range; floating-point samples are needed");
    if (holds_inks(spec))
        return true;
    if (!foreign_colours(spec).empty())
        return fail(message, "holds " + foreign_colours(spec) + " colours; convert it to RGB or grey first");
    if (image_channels(spec) == 0) {
        std::string names = OIIO::Strutil::join(spec.channelnames, ", ");
        return fail(message, "has the channels " + names + "; grey or RGB, with or without alpha, is needed");
    }
    return true;
}

// The number of floating-point samples that the encoder clamps, beyond the errors of conversions.  It refuses infinite ones.
uint64_t count_clamped(const gscl_image &image) {
    const float tolerance = 1.0f / 512;
    const float *samples = static_cast<const float *>(image.pixels);
    if (image.sample != GSCL_SAMPLE_F32)
        return 0;
    return uint64_t(std::count_if(samples, samples + size_t(image.width) * image.height * image.channels,
                                  [=](float v) { return std::isfinite(v) && (v < -tolerance || v > 1 + tolerance); }));
}

// Whether the file has frames or pages beside the first.  Moves on to the second.
bool has_more_images(OIIO::ImageInput &input) {
    const int REDUCED = 1; // of the tag NewSubfileType: a preview of the first
    if (std::strcmp(input.format_name(), "psd") == 0)
        return false; // they are the layers of the first
    const bool found = input.seek_subimage(1, 0);
    input.geterror(); // forgets why there is none
    return found && !(input.spec().get_int_attribute("tiff:subfiletype") & REDUCED);
}

// Copies the part of the pixels that lies in the image, and clears the rest.
void place_pixels(const window &from, const std::vector<char> &pixels, const window &to, gscl_image &image) {
    const size_t pixel = image.channels * image_sample_size(image.sample);
    const int left = std::max(from.x, to.x), right = std::min(from.x + from.width, to.x + to.width);
    std::memset(image.pixels, 0, size_t(to.width) * size_t(to.height) * pixel);
    for (int y = std::max(from.y, to.y); left < right && y < std::min(from.y + from.height, to.y + to.height); y++) {
        const char *row = pixels.data() + (size_t(y - from.y) * size_t(from.width) + size_t(left - from.x)) * pixel;
        char *target = static_cast<char *>(image.pixels);
        std::memcpy(target + (size_t(y - to.y) * size_t(to.width) + size_t(left - to.x)) * pixel, row,
                    size_t(right - left) * pixel);
    }
}

bool read_samples(OIIO::ImageInput &input, gscl_image &image, char *message) {
    const window held = data_window(input.spec()), shown = shown_window(input);
    std::vector<char> pixels;
    if (!is_same(held, shown))
        pixels.resize(size_t(held.width) * size_t(held.height) * image.channels * image_sample_size(image.sample));
    if (!input.read_image(0, 0, 0, int(image.channels), type_of(image.sample),
                          pixels.empty() ? image.pixels : pixels.data()))
        return fail(message, "cannot be read: " + reason(input.geterror()));
    if (!pixels.empty())
        place_pixels(held, pixels, shown, image);
    return true;
}

bool is_premultiplied(const OIIO::ImageSpec &spec, const image_content &content) {
    if (content.image.channels % 2 == 1)
        return false;
    return content.alpha == IMAGE_ALPHA_AS_READ ? !spec.get_int_attribute("oiio:UnassociatedAlpha")
                                                : content.alpha == IMAGE_ALPHA_PREMULTIPLIED;
}

bool read_pixels(OIIO::ImageInput &input, image_content &content, char *message) {
    gscl_image &image = content.image;
    if (!read_samples(input, image, message))
        return false;
    if (content.cmyk)
        return true;
    image.premultiplied = is_premultiplied(input.spec(), content);
    if (holds_linear_light(input.spec())) {
        to_straight_srgb(image);
        image.premultiplied = false;
    }
    return true;
}

// Copies what OpenImageIO found beside the pixels.
void take_metadata(const OIIO::ImageSpec &spec, image_content &content) {
    const OIIO::ParamValue *icc = spec.find_attribute("ICCProfile");
    if (icc && icc->type().basetype == OIIO::TypeDesc::UINT8)
        content.damaged_profile = !image_blob_set(&content.metadata.icc, icc->data(), icc->type().size());
    float red_to_white[8];
    if (spec.getattribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), red_to_white)) {
        content.has_primaries = true;
        for (int i = 0; i < 8; i++)
            content.primaries[i] = red_to_white[(i + 6) % 8];
    }
    content.orientation = spec.get_int_attribute("Orientation", content.orientation);
}

std::unique_ptr<OIIO::ImageInput> open_input(const char *plugin, const char *path, OIIO::Filesystem::IOProxy *bytes,
                                             bool inks, char *message) {
    OIIO::ImageSpec config, spec;
    config["oiio:UnassociatedAlpha"] = 1; // straight colours stay as the file has them
    if (inks)
        config["oiio:RawColor"] = 1;
    if (bytes) // some plug-ins forget a proxy that comes as an argument
        config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &bytes);
    auto input = OIIO::ImageInput::create(plugin, false, nullptr, bytes);
    if (!input) {
        fail(message, "is not an image that can be read: " + reason(OIIO::geterror()));
    } else if (!input->open(path, spec, config)) {
        fail(message, "is not an image that can be read: " + reason(input->geterror()));
        input = nullptr;
    }
    return input;
}

// The number of channels to read: without a last one that means nothing.
uint32_t wanted_channels(const OIIO::ImageSpec &spec, const image_content &content) {
    if (holds_inks(spec))
        return 4;
    const uint32_t channels = uint32_t(image_channels(spec));
    return channels % 2 == 0 && content.alpha == IMAGE_ALPHA_UNUSED ? channels - 1 : channels;
}

bool read_file(const char *plugin, const char *path, const uint8_t *bytes, size_t size, image_content *content,
               char *message) {
    OIIO::Filesystem::IOMemReader memory(const_cast<uint8_t *>(bytes), size); // it only reads
    auto input = open_input(plugin, path, bytes ? &memory : nullptr, content->cmyk, message);
    if (!input)
        return false;
    const OIIO::ImageSpec &spec = input->spec();
    if (!check_spec(*input, message))
        return false;
    if (content->alpha == IMAGE_ALPHA_REFUSED && spec.nchannels % 2 == 0)
        return fail(message, "has transparent parts, which are not read from this format; convert it to PNG first");
    const window shown = shown_window(*input);
    gscl_image &image = content->image;
    image.width = uint32_t(shown.width);
    image.height = uint32_t(shown.height);
    image.channels = wanted_channels(spec, *content);
    image.sample = sample_for(spec);
    image.pixels = std::malloc(size_t(image.width) * image.height * image.channels * image_sample_size(image.sample));
    if (!image.pixels)
        return fail(message, "is too large for the available memory");
    content->cmyk = holds_inks(spec);
    take_metadata(spec, *content);
    if (!read_pixels(*input, *content, message))
        return false;
    content->clamped = count_clamped(image);
    content->has_more_images = has_more_images(*input);
    return true;
}

// ---- Writing --------------------------------------------------------------------------------------

OIIO::ImageSpec output_spec(const gscl_image &image) {
    OIIO::ImageSpec spec(int(image.width), int(image.height), int(image.channels), type_of(image.sample));
    if (image.channels % 2 == 0) {
        spec.alpha_channel = int(image.channels) - 1;
        spec.channelnames[spec.alpha_channel] = "A";
    }
    if (image.channels <= 2)
        spec.channelnames[0] = "Y";
    return spec;
}

// OpenEXR holds linear light multiplied by alpha; all other formats with alpha can hold it straight.
void prepare_colours(OIIO::ImageSpec &spec, gscl_image &image, std::vector<float> &pixels) {
    if (image.sample != GSCL_SAMPLE_F32) {
        spec["oiio:UnassociatedAlpha"] = 1;
        return;
    }
    const float *samples = static_cast<const float *>(image.pixels);
    pixels.assign(samples, samples + size_t(image.width) * image.height * image.channels);
    image.pixels = pixels.data();
    to_premultiplied_linear(image);
    spec["oiio:ColorSpace"] = "Linear";
}

// Makes RGBA of grey and alpha of 8 bits, which TGA can hold, but few readers know.
void widen_grey(gscl_image &image, std::vector<uint8_t> &samples) {
    const uint8_t *from = static_cast<const uint8_t *>(image.pixels);
    samples.reserve(size_t(image.width) * image.height * 4);
    for (size_t left = size_t(image.width) * image.height; left > 0; left--, from += 2)
        samples.insert(samples.end(), {from[0], from[0], from[0], from[1]});
    image.pixels = samples.data();
    image.channels = 4;
}

// Writes into the stream of the tool and keeps the first error, because the libraries of some formats ignore a full disk
// or end the program.
class StreamProxy : public OIIO::Filesystem::IOProxy {
  public:
    explicit StreamProxy(FILE *stream) : IOProxy("", Mode::Write), stream_(stream) {
    }
    const char *proxytype() const override {
        return "gscl-stream";
    }
    size_t write(const void *bytes, size_t size) override {
        if (error_ == 0 && (!move_to(m_pos) || std::fwrite(bytes, 1, size, stream_) != size))
            error_ = errno ? errno : EIO;
        m_pos = position_ += int64_t(size);
        size_ = std::max(size_, m_pos);
        return error_ == 0 ? size : 0;
    }
    size_t size() const override {
        return size_t(size_);
    }
    // errno of the first failure, or 0.
    int error_number() const {
        return error_;
    }

  private:
    bool move_to(int64_t position) {
        const bool there = position == position_ || fseeko(stream_, off_t(position), SEEK_SET) == 0;
        position_ = position;
        return there;
    }

    FILE *stream_;
    int64_t position_ = 0, size_ = 0; // of the stream
    int error_ = 0;
};

bool write_file(FILE *stream, const char *suffix, const gscl_image *image, char *message) {
    const std::string name = std::string("image") + suffix;
    StreamProxy proxy(stream);
    auto output = OIIO::ImageOutput::create(name, &proxy);
    if (!output)
        return fail(message, "cannot be written: " + reason(OIIO::geterror()));
    gscl_image prepared = *image;
    std::vector<float> pixels;
    std::vector<uint8_t> widened;
    if (std::strcmp(output->format_name(), "targa") == 0 && prepared.channels == 2)
        widen_grey(prepared, widened);
    OIIO::ImageSpec spec = output_spec(prepared);
    prepare_colours(spec, prepared, pixels);
    const bool written =
        output->open(name, spec) && output->write_image(type_of(prepared.sample), prepared.pixels) && output->close();
    if (proxy.error_number() != 0)
        return fail(message, std::string("cannot be written: ") + std::strerror(proxy.error_number()));
    return written || fail(message, "cannot be written: " + reason(output->geterror()));
}

// Catches all exceptions: none may pass into the tool, which is C.
template <typename Function> bool guarded(char *message, Function function) noexcept {
    try {
        return function();
    } catch (const std::exception &error) {
        return fail(message, std::string("cannot be handled by the image library: ") + error.what());
    }
}

bool guarded_read(const char *plugin, const char *path, const uint8_t *bytes, size_t size, image_content *content,
                  char *message) noexcept {
    return guarded(message, [=] { return read_file(plugin, path, bytes, size, content, message); });
}

bool guarded_write(FILE *stream, const char *suffix, const gscl_image *image, char *message) noexcept {
    return guarded(message, [=] { return write_file(stream, suffix, image, message); });
}
} // namespace

extern "C" __attribute__((visibility("default"))) const image_module gscl_image_module;
const image_module gscl_image_module = {guarded_read, image_read_jpeg2000, guarded_write};
