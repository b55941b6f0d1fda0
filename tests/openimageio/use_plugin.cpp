// What programs do with the plug-in beyond oiiotool.  Prints TAP.
//     use_plugin IN.gscl           reads a picture of more than 256 pixels in many ways
//     use_plugin FOLDER IN.gscl... decodes each file: writes its samples to FOLDER/N.raw and prints "WIDTH HEIGHT CHANNELS
//                                  BITS", or prints "refused"
//     use_plugin write OUT.gscl... writes a grey picture by each name (oiiotool writes by another, which it then renames)
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imageio.h>

using OIIO::ImageBuf;
using OIIO::ImageInput;
using OIIO::ImageOutput;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

namespace {

int count, failures;

void check(bool ok, const char *what) {
    count++;
    failures += !ok;
    std::printf("%s %d - %s\n", ok ? "ok" : "not ok", count, what);
}

std::vector<unsigned char> read_all(const std::string &name, const ImageSpec *config = nullptr) {
    auto input = ImageInput::open(name, config);
    std::vector<unsigned char> pixels(input ? input->spec().image_bytes() : 0);
    if (input && !input->read_image(0, 0, 0, -1, TypeDesc::UINT8, pixels.data()))
        pixels.clear();
    return pixels;
}

void test_thumbnail(const std::string &name) {
    auto input = ImageInput::open(name);
    ImageBuf thumbnail;
    check(input && input->supports("thumbnail") && input->get_thumbnail(thumbnail, 0), "a thumbnail is drawn");
    if (!input || !thumbnail.initialized())
        return;
    const ImageSpec &spec = thumbnail.spec();
    check(spec.width == 256 && spec.width == input->spec().get_int_attribute("thumbnail_width") &&
              spec.height == input->spec().get_int_attribute("thumbnail_height"),
          "it has the size that the attributes say");
    ImageSpec config;
    config["gscl:width"] = spec.width;
    config["gscl:height"] = spec.height;
    std::vector<unsigned char> pixels(spec.image_bytes());
    thumbnail.get_pixels(OIIO::get_roi(spec), TypeDesc::UINT8, pixels.data());
    check(pixels == read_all(name, &config), "it is the picture drawn at that size");
}

void test_rows(const std::string &name) {
    const std::vector<unsigned char> all = read_all(name);
    auto input = ImageInput::open(name);
    if (!input || all.empty())
        return check(false, "the picture is read");
    const ImageSpec spec = input->spec();
    const size_t row = spec.scanline_bytes();
    std::vector<unsigned char> part(row * 10);
    check(input->read_scanlines(0, 0, 20, 30, 0, 0, spec.nchannels, TypeDesc::UINT8, part.data()) &&
              std::memcmp(part.data(), all.data() + 20 * row, part.size()) == 0,
          "some rows are those of the whole picture");
    check(!input->read_scanline(spec.height, 0, TypeDesc::UINT8, part.data()), "there is no row below the last");
    check(!input->seek_subimage(0, 1) && !input->seek_subimage(1, 0), "there is one picture");
}

void test_large(const std::string &name) {
    ImageSpec config;
    config["gscl:width"] = 6000; // several bands of rows
    auto input = ImageInput::open(name, &config);
    if (!input)
        return check(false, "a large picture is opened");
    const int rows = input->spec().height;
    const size_t row = input->spec().scanline_bytes();
    std::vector<unsigned char> all(row * size_t(rows)), last(row);
    check(input->read_image(0, 0, 0, -1, TypeDesc::UINT8, all.data()), "a large picture is read in bands");
    auto again = ImageInput::open(name, &config);
    check(again && again->read_scanline(rows - 1, 0, TypeDesc::UINT8, last.data()) &&
              std::memcmp(last.data(), all.data() + row * size_t(rows - 1), row) == 0,
          "its last row alone is the same");
}

void test_memory(const std::string &name) {
    std::vector<unsigned char> bytes(OIIO::Filesystem::file_size(name));
    OIIO::Filesystem::read_bytes(name, bytes.data(), bytes.size());
    OIIO::Filesystem::IOMemReader reader(bytes.data(), bytes.size());
    auto input = ImageInput::open("memory.gscl", nullptr, &reader);
    const std::vector<unsigned char> all = read_all(name);
    std::vector<unsigned char> pixels(all.size());
    check(input && input->read_image(0, 0, 0, -1, TypeDesc::UINT8, pixels.data()) && pixels == all,
          "a file in memory is read");

    const std::vector<unsigned char> grey(32 * 16, 128);
    std::vector<unsigned char> written;
    OIIO::Filesystem::IOVecOutput writer(written);
    auto output = ImageOutput::create("memory.gscl", &writer);
    ImageSpec spec(32, 16, 1, TypeDesc::UINT8);
    spec["gscl:effort"] = 0;
    check(output && output->open("memory.gscl", spec) && output->write_image(TypeDesc::UINT8, grey.data()) &&
              output->close() && written.size() > 8 && written[0] == 0xC7,
          "a file is written to memory");
}

void test_missing_rows(const std::string &name) {
    const std::string made = name + ".rows.gscl";
    const std::vector<unsigned char> row(32);
    auto output = ImageOutput::create(made);
    ImageSpec spec(32, 16, 1, TypeDesc::UINT8);
    check(output && output->open(made, spec) && output->write_scanline(0, 0, TypeDesc::UINT8, row.data()) &&
              !output->close() && output->geterror() == "15 of 16 rows were not written; the file is not made" &&
              !OIIO::Filesystem::exists(made),
          "a picture without all rows is not written");
}

// Pictures of more pixels are opened only.
constexpr uint64_t most_pixels = 4000000;

void decode_one(const std::string &name, const std::string &raw) {
    ImageSpec config;
    config["oiio:UnassociatedAlpha"] = 1;
    auto input = ImageInput::open(name, &config);
    if (!input)
        return void(std::puts("refused"));
    const ImageSpec &spec = input->spec();
    std::vector<unsigned char> samples(spec.image_pixels() <= most_pixels ? spec.image_bytes() : 0);
    if (!samples.empty() && !input->read_image(0, 0, 0, -1, spec.format, samples.data()))
        return void(std::puts("refused"));
    OIIO::Filesystem::write_binary_file(raw, samples);
    std::printf("%d %d %d %d\n", spec.width, spec.height, spec.nchannels, int(spec.format.size()) * 8);
}

bool write_grey(const std::string &name) {
    const std::vector<unsigned char> grey(32 * 16, 128);
    auto output = ImageOutput::create(name);
    ImageSpec spec(32, 16, 1, TypeDesc::UINT8);
    spec["gscl:effort"] = 0;
    const bool ok = output && output->open(name, spec) && output->write_image(TypeDesc::UINT8, grey.data());
    if (ok && output->close())
        return true;
    std::puts(output ? output->geterror().c_str() : OIIO::geterror().c_str());
    return false;
}

} // namespace

int main(int argc, char **argv) {
    if (argc > 2 && std::strcmp(argv[1], "write") == 0) {
        for (int i = 2; i < argc; i++)
            failures += !write_grey(argv[i]);
        return failures != 0;
    }
    for (int i = 2; i < argc; i++)
        decode_one(argv[i], std::string(argv[1]) + "/" + std::to_string(i - 2) + ".raw");
    if (argc != 2)
        return argc < 2;
    test_thumbnail(argv[1]);
    test_rows(argv[1]);
    test_large(argv[1]);
    test_memory(argv[1]);
    test_missing_rows(argv[1]);
    std::printf("1..%d\n", count);
    return failures != 0;
}
