// What the reader and the writer of the OpenImageIO plug-in share: the library's errors and contexts.
#ifndef GSCL_OPENIMAGEIO_PLUGIN_H
#define GSCL_OPENIMAGEIO_PLUGIN_H

#include <cstdint>
#include <string>
#include <vector>

#include <OpenImageIO/imageio.h>

#include <gscl/gscl.h>

namespace gscl_plugin {

// A device that is open, or that failed to open; freed with this object.
class Context {
  public:
    // `device` as in gscl_context_settings; empty for the default of the library.
    explicit Context(const std::string &device) {
        gscl_context_settings settings;
        gscl_context_settings_default(&settings);
        settings.device = device.empty() ? nullptr : device.c_str();
        result_ = gscl_context_create(&context_, &settings);
    }
    ~Context() {
        gscl_context_free(&context_);
    }
    Context(const Context &) = delete;
    Context &operator=(const Context &) = delete;

    gscl_context *get() const {
        return context_;
    }
    gscl_result result() const {
        return result_;
    }
    // The detailed text of an error of the library, without the name of a file.
    std::string message(gscl_result result) const {
        const char *detail = context_ ? gscl_context_message(context_) : "";
        return *detail ? detail : gscl_result_text(result);
    }

  private:
    gscl_context *context_ = nullptr;
    gscl_result result_ = GSCL_OK;
};

inline OIIO::TypeDesc type_of(gscl_sample sample) {
    return sample == GSCL_SAMPLE_U8    ? OIIO::TypeDesc::UINT8
           : sample == GSCL_SAMPLE_U16 ? OIIO::TypeDesc::UINT16
                                       : OIIO::TypeDesc::FLOAT;
}

// The value of an attribute that is a number of any type; `otherwise` where it is missing or no number.
inline double number_of(const OIIO::ImageSpec &spec, const char *name, double otherwise) {
    const OIIO::ParamValue *value = spec.find_attribute(name);
    if (!value)
        return otherwise;
    return value->type() == OIIO::TypeDesc::INT ? double(value->get_int()) : double(value->get_float(float(otherwise)));
}

// Names the channels as gscl has them: Y or R, G, B, then A.
inline void name_channels(OIIO::ImageSpec &spec) {
    if (spec.nchannels <= 2)
        spec.channelnames[0] = "Y";
    if (spec.nchannels % 2 == 0) {
        spec.alpha_channel = spec.nchannels - 1;
        spec.channelnames[spec.alpha_channel] = "A";
    }
}

} // namespace gscl_plugin
#endif
