// What is written as OpenEXR comes back to the bit; what other programs wrote is read or refused, never guessed.

#include "image/exr.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTiledOutputFile.h>
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cstring>
#include <fstream>
#include <iterator>

#include "core/error.h"
#include "core/random.h"
#include "image/metrics.h"
#include "image/png.h"
#include "scratch_folder.h"

namespace photonlab {
namespace {

constexpr float float_infinity = std::numeric_limits<float>::infinity();
constexpr float quiet_nan = std::numeric_limits<float>::quiet_NaN();

// Equality of representations: tells -0 from 0 and finds NaN equal to itself.
bool same_bits(const std::vector<Color>& a, const std::vector<Color>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Color)) == 0;
}

Image random_image(int width, int height) {
    Image image{.width = width, .height = height, .layers = {}};
    std::uint64_t layer_index = 0;
    for (std::string_view name : {emission_layer, direct_layer, gathered_layer}) {
        RandomStream random(1, RandomPurpose::Test, layer_index++, 0);
        Layer layer{.name = std::string(name), .pixels = {}};
        for (int i = 0; i < width * height; ++i) {
            const float red = random.next(), green = random.next();
            layer.pixels.emplace_back(red * 1e-3f, green, random.next() * 1e4f);
        }
        image.layers.push_back(layer);
    }
    return image;
}

template <typename Action>
std::string message_of(const Action& action) {
    try {
        action();
    } catch (const InputError& error) {
        return error.what();
    }
    return "(nothing was thrown)";
}

testing::AssertionResult contains(const std::string& message, const std::string& part) {
    if (message.find(part) != std::string::npos) return testing::AssertionSuccess();
    return testing::AssertionFailure() << "expected \"" << part << "\" in the message: " << message;
}

#define EXPECT_MESSAGE(action, part) EXPECT_TRUE(contains(message_of([&] { action; }), part))

// A file as another program writes it: every channel holds x + 10 y + 100 * (its place in `names`).
struct ForeignFile {
    std::vector<std::string> names = {"R", "G", "B"};
    Imf::PixelType type = Imf::HALF;
    Imath::Box2i data_window = {{0, 0}, {3, 2}};
    Imf::Compression compression = Imf::PIZ_COMPRESSION;
    bool tiled = false;
    int sampling = 1;
    std::string layers = "";  ///< of photonlab.layers, if there is any

    static float value(int x, int y, int channel) { return static_cast<float>(x + 10 * y + 100 * channel); }

    void write(const std::filesystem::path& file) const {
        const int width = data_window.max.x - data_window.min.x + 1;
        const int height = data_window.max.y - data_window.min.y + 1;
        Imf::Header header(Imath::Box2i({0, 0}, {9, 9}), data_window);
        header.compression() = compression;
        if (!layers.empty()) header.insert("photonlab.layers", Imf::StringAttribute(layers));
        if (tiled) header.setTileDescription(Imf::TileDescription(2, 2, Imf::ONE_LEVEL));

        const std::size_t bytes = type == Imf::HALF ? 2 : 4;
        std::vector<std::vector<char>> planes;
        Imf::FrameBuffer frame;
        for (std::size_t channel = 0; channel < names.size(); ++channel) {
            std::vector<char>& plane = planes.emplace_back(bytes * static_cast<std::size_t>(width * height));
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x) {
                    const float number = value(x, y, static_cast<int>(channel));
                    const half as_half(number);
                    const auto as_integer = static_cast<std::uint32_t>(number);
                    const void* source = type == Imf::HALF    ? static_cast<const void*>(&as_half)
                                         : type == Imf::FLOAT ? static_cast<const void*>(&number)
                                                              : static_cast<const void*>(&as_integer);
                    std::memcpy(plane.data() + bytes * static_cast<std::size_t>(y * width + x), source, bytes);
                }
        }
        for (std::size_t channel = 0; channel < names.size(); ++channel) {
            header.channels().insert(names[channel], Imf::Channel(type, sampling, sampling));
            frame.insert(names[channel], Imf::Slice::Make(type, planes[channel].data(), data_window, bytes,
                                                          bytes * static_cast<std::size_t>(width), sampling, sampling));
        }
        if (tiled) {
            Imf::TiledOutputFile output(file.string().c_str(), header);
            output.setFrameBuffer(frame);
            output.writeTiles(0, output.numXTiles() - 1, 0, output.numYTiles() - 1);
        } else {
            Imf::OutputFile output(file.string().c_str(), header);
            output.setFrameBuffer(frame);
            output.writePixels(height);
        }
    }
};

void expect_foreign_values(const Image& image) {
    ASSERT_EQ(image.width, 4);
    ASSERT_EQ(image.height, 3);
    ASSERT_EQ(image.layers.size(), 1u);
    EXPECT_EQ(image.layers[0].name, "total");
    for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 4; ++x)
            for (int channel = 0; channel < 3; ++channel)
                EXPECT_EQ(image.layers[0].pixels[static_cast<std::size_t>(4 * y + x)][channel],
                          ForeignFile::value(x, y, channel));
}

TEST(Exr, LayersComeBackToTheBitInTheirOrder) {
    const ScratchFolder folder;
    const Image written = random_image(37, 21);
    for (const ExrCompression compression : {ExrCompression::Fast, ExrCompression::Small}) {
        write_exr(folder / "image.exr", written, {}, compression);
        const Image read = read_exr(folder / "image.exr");

        EXPECT_EQ(read.width, 37);
        EXPECT_EQ(read.height, 21);
        ASSERT_EQ(read.layers.size(), 3u);
        for (std::size_t i = 0; i < 3; ++i) {
            EXPECT_EQ(read.layers[i].name, written.layers[i].name);
            EXPECT_TRUE(same_bits(read.layers[i].pixels, written.layers[i].pixels));
        }
        EXPECT_EQ(total(read), total(written));
    }
}

TEST(Exr, ExtremeValuesComeBackToTheBit) {
    const ScratchFolder folder;
    const float largest = std::numeric_limits<float>::max();
    const float denormal = std::numeric_limits<float>::denorm_min();
    const std::vector<Color> pixels = {{denormal, -denormal, 0.0f},
                                       {-0.0f, largest, -largest},
                                       {std::numeric_limits<float>::min(), 1.0f + 0x1p-23f, 1e-40f},
                                       {float_infinity, -float_infinity, quiet_nan}};
    write_exr(folder / "image.exr", {.width = 4, .height = 1, .layers = {{"direct", pixels}}});
    EXPECT_TRUE(same_bits(read_exr(folder / "image.exr").layers.at(0).pixels, pixels));
}

TEST(Exr, ValuesThatAreNotFiniteAreWrittenAndThenCountedByCompare) {
    const ScratchFolder folder;
    const std::vector<Color> pixels = {Color(1.0f), {1.0f, float_infinity, 1.0f}, {quiet_nan, 1.0f, 1.0f}};
    write_exr(folder / "image.exr", {.width = 3, .height = 1, .layers = {{"gathered", pixels}}});
    const ErrorMetrics metrics = compare(total(read_exr(folder / "image.exr")),
                                         {.mean = std::vector<ColorD>(3, ColorD(1.0)), .half_a = {}, .half_b = {}});
    EXPECT_EQ(metrics.nonfinite, 2u);
    EXPECT_EQ(metrics.first_nonfinite, 1u);
    EXPECT_EQ(metrics.of("mse").value(), 0.0);
}

TEST(Exr, OtherProgramsSeeTheSumOfTheLayersInRgb) {
    const ScratchFolder folder;
    const Image written = random_image(5, 4);
    write_exr(folder / "image.exr", written);
    std::vector<float> red(20);
    Imf::InputFile input((folder / "image.exr").string().c_str());
    ASSERT_NE(input.header().channels().findChannel("gathered.B"), nullptr);
    EXPECT_EQ(input.header().channels().findChannel("gathered.B")->type, Imf::FLOAT);
    Imf::FrameBuffer frame;
    frame.insert("R", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(red.data()), 4, 20));
    input.setFrameBuffer(frame);
    input.readPixels(0, 3);
    const std::vector<ColorD> sum = total(written);
    for (std::size_t i = 0; i < red.size(); ++i) EXPECT_EQ(red[i], static_cast<float>(sum[i].x));
}

TEST(Exr, TheRadiusIsOneChannelThatIsNoLayer) {
    const ScratchFolder folder;
    Image image = random_image(7, 5);
    for (int i = 0; i < 35; ++i) image.radius.push_back(static_cast<float>(i) * 0.1f);
    image.count = image.radius;
    const std::filesystem::path file = folder / "image.exr";
    write_exr(file, image);
    std::vector<float> radius(35);
    Imf::InputFile input(file.string().c_str());
    Imf::FrameBuffer frame;
    frame.insert("radius", Imf::Slice::Make(Imf::FLOAT, radius.data(), input.header().dataWindow()));
    input.setFrameBuffer(frame);
    input.readPixels(0, 4);
    EXPECT_EQ(radius, image.radius);
    EXPECT_TRUE(input.header().channels().findChannel("count"));
    EXPECT_FALSE(input.header().channels().findChannel("density")) << "there is none";
    EXPECT_EQ(read_exr(file).layers.size(), image.layers.size());
}

TEST(Exr, IsCompressedAsItIsAskedFor) {
    const ScratchFolder folder;
    const auto compression = [&](ExrCompression asked) {
        write_exr(folder / "image.exr", random_image(5, 4), {}, asked);
        return Imf::InputFile((folder / "image.exr").string().c_str()).header().compression();
    };
    EXPECT_EQ(compression(ExrCompression::Fast), Imf::RLE_COMPRESSION);
    EXPECT_EQ(compression(ExrCompression::Small), Imf::ZIP_COMPRESSION);
}

TEST(Exr, OneLayerCalledTotalIsAnOrdinaryRgbFile) {
    const ScratchFolder folder;
    const std::vector<Color> pixels = {{1.0f, 2.0f, 3.0f}, {4.0f, 5.0f, 6.0f}};
    write_exr(folder / "image.exr", {.width = 1, .height = 2, .layers = {{"total", pixels}}});
    const Imf::InputFile input((folder / "image.exr").string().c_str());
    EXPECT_EQ(input.header().channels().findChannel("total.R"), nullptr);
    const Image read = read_exr(folder / "image.exr");
    ASSERT_EQ(read.layers.size(), 1u);
    EXPECT_EQ(read.layers[0].name, "total");
    EXPECT_TRUE(same_bits(read.layers[0].pixels, pixels));
}

TEST(Exr, MetadataComesBack) {
    const ScratchFolder folder;
    const Metadata written = {{"photonlab.alpha", "0.66666666666666663"},
                              {"note", "two lines\nand \xc3\xa9"},
                              {"empty", ""},
                              {"a name well over the thirty-one characters of short names", "yes"}};
    write_exr(folder / "image.exr", random_image(2, 2), written);
    Metadata read = {{"left over", "from before"}};
    read_exr(folder / "image.exr", &read);
    EXPECT_EQ(read, written);
}

TEST(Exr, RefusesMetadataUnderANameThatOpenExrUses) {
    const ScratchFolder folder;
    for (const char* name : {"compression", "type", "photonlab.layers"}) {
        EXPECT_MESSAGE(write_exr(folder / "image.exr", random_image(2, 2), {{name, "x"}}), "image.exr: ");
        EXPECT_MESSAGE(write_exr(folder / "image.exr", random_image(2, 2), {{name, "x"}}), name);
    }
}

TEST(Exr, ReplacesAnOlderFileAndLeavesNothingElseBehind) {
    const ScratchFolder folder;
    write_exr(folder / "image.exr", random_image(9, 9));
    write_exr(folder / "image.exr", random_image(2, 2));
    EXPECT_EQ(read_exr(folder / "image.exr").width, 2);
    const auto entries = std::filesystem::directory_iterator(folder.path());
    EXPECT_EQ(std::distance(begin(entries), end(entries)), 1);
}

TEST(Exr, RefusesAFolderThatCannotBeWrittenTo) {
    const ScratchFolder folder;
    EXPECT_MESSAGE(write_exr(folder / "nowhere/image.exr", random_image(2, 2)), "nowhere/image.exr: cannot be written");
    EXPECT_MESSAGE(write_exr(folder / "nowhere/image.exr", random_image(2, 2)), "No such file");
    EXPECT_MESSAGE(write_exr("/proc/image.exr", random_image(2, 2)), "/proc/image.exr: cannot be written");
}

TEST(Exr, LeavesNoTemporaryFileWhenTheFinalNameIsTaken) {
    const ScratchFolder folder;
    std::filesystem::create_directories(folder / "image.exr/inside");
    EXPECT_MESSAGE(write_exr(folder / "image.exr", random_image(2, 2)), "image.exr: cannot be written");
    const auto entries = std::filesystem::directory_iterator(folder.path());
    EXPECT_EQ(std::distance(begin(entries), end(entries)), 1);
}

TEST(Exr, RefusesWhatIsNotThereOrAFolder) {
    const ScratchFolder folder;
    EXPECT_MESSAGE(read_exr(folder / "none.exr"), "none.exr: cannot be read: No such file");
    EXPECT_MESSAGE(read_exr(folder.path()), "is a folder");
}

TEST(Exr, RefusesAPngFile) {
    const ScratchFolder folder;
    write_png(folder / "picture.exr", 2, 2, std::vector<ColorD>(4, ColorD(0.5)));
    EXPECT_MESSAGE(read_exr(folder / "picture.exr"), "picture.exr: is not an OpenEXR file");
}

TEST(Exr, RefusesAFileCutAnywhere) {
    const ScratchFolder folder;
    write_exr(folder / "whole.exr", random_image(40, 40));
    std::ifstream input(folder / "whole.exr", std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(input)), std::istreambuf_iterator<char>());
    ASSERT_GT(bytes.size(), 1000u);
    for (std::size_t length = 0; length < bytes.size(); length += length < 1500 ? 31 : 997) {
        std::ofstream(folder / "cut.exr", std::ios::binary) << bytes.substr(0, length);
        EXPECT_MESSAGE(read_exr(folder / "cut.exr"), "cut.exr: ") << "at " << length;
    }
    std::ofstream(folder / "cut.exr", std::ios::binary) << bytes.substr(0, bytes.size() - 1);
    EXPECT_MESSAGE(read_exr(folder / "cut.exr"), "cut.exr: ");
}

TEST(Exr, ReadsChannelsOfEveryTypeFromOtherPrograms) {
    const ScratchFolder folder;
    for (const Imf::PixelType type : {Imf::HALF, Imf::FLOAT, Imf::UINT}) {
        ForeignFile{.type = type}.write(folder / "foreign.exr");
        expect_foreign_values(read_exr(folder / "foreign.exr"));
    }
}

TEST(Exr, ReadsADataWindowAwayFromZero) {
    const ScratchFolder folder;
    for (const Imath::V2i& corner : {Imath::V2i(-7, -100), Imath::V2i(1000, 5)}) {
        const ForeignFile foreign{.type = Imf::FLOAT, .data_window = {corner, corner + Imath::V2i(3, 2)}};
        foreign.write(folder / "foreign.exr");
        expect_foreign_values(read_exr(folder / "foreign.exr"));
    }
}

TEST(Exr, ReadsTiles) {
    const ScratchFolder folder;
    ForeignFile{.compression = Imf::ZIP_COMPRESSION, .tiled = true}.write(folder / "foreign.exr");
    expect_foreign_values(read_exr(folder / "foreign.exr"));
}

TEST(Exr, LeavesOutAlphaAndAuxiliaryChannelsOfOtherPrograms) {
    const ScratchFolder folder;
    ForeignFile{.names = {"R", "G", "B", "A", "Y", "albedo.R", "albedo.G", "albedo.B"}}.write(folder / "foreign.exr");
    expect_foreign_values(read_exr(folder / "foreign.exr"));
}

// What another program leaves of our files: its list of layers, and not all of the layers.
TEST(Exr, ThePictureIsRgbWhateverIsLeftOfItsLayers) {
    const ScratchFolder folder;
    for (const bool tiled : {false, true}) {
        ForeignFile file{.tiled = tiled, .layers = "emission,direct,gathered"};
        file.write(folder / "rgb.exr");
        expect_foreign_values(read_exr(folder / "rgb.exr"));

        file.names = {"R", "G", "B", "A", "direct.R", "direct.G", "direct.B", "gathered.R", "gathered.G"};
        file.write(folder / "some.exr");
        for (const std::string component : {"total", "direct", "gathered"}) {
            const Image image = read_exr(folder / "some.exr", nullptr, component);
            ASSERT_EQ(image.layers.size(), 2u);
            EXPECT_EQ(image.layers[0].name, "direct");
            EXPECT_EQ(image.layers[1].name, "rest");
            EXPECT_EQ(image.layers[0].pixels[5], Color(411, 511, 611)) << "x 1, y 1";
            EXPECT_EQ(total(image)[5], ColorD(11, 111, 211));
        }
    }
}

TEST(Exr, LayersAreReadWithoutThePictureWhereItIsNotAskedFor) {
    const ScratchFolder folder;
    ForeignFile{.names = {"direct.R", "direct.G", "direct.B", "R"}, .layers = "emission,direct"}.write(folder /
                                                                                                       "a.exr");
    EXPECT_MESSAGE(read_exr(folder / "a.exr"), "has no channel G; it has: R, direct.B, direct.G, direct.R");
    const Image image = read_exr(folder / "a.exr", nullptr, "direct");
    ASSERT_EQ(image.layers.size(), 1u);
    EXPECT_EQ(image.layers[0].name, "direct");
    EXPECT_EQ(image.layers[0].pixels[5], Color(11, 111, 211));

    // All layers are the picture.
    ForeignFile{.names = {"a.R", "a.G", "a.B", "b.R", "b.G", "b.B"}, .layers = "b,a"}.write(folder / "b.exr");
    EXPECT_EQ(total(read_exr(folder / "b.exr"))[5], ColorD(11 + 311, 111 + 411, 211 + 511));

    // Of another renderer's file only what is asked for by name.
    ForeignFile{.names = {"R", "G", "B", "direct.R", "direct.G", "direct.B"}}.write(folder / "c.exr");
    expect_foreign_values(read_exr(folder / "c.exr"));
    expect_foreign_values(read_exr(folder / "c.exr", nullptr, "gathered"));
    const Image asked = read_exr(folder / "c.exr", nullptr, "direct");
    EXPECT_EQ((*asked.find("direct"))[5], Color(311, 411, 511));
    EXPECT_EQ(total(asked)[5], ColorD(11, 111, 211));
}

TEST(Exr, APictureThatWasChangedAloneIsThePicture) {
    const ScratchFolder folder;
    write_exr(folder / "a.exr", random_image(5, 4));
    EXPECT_EQ(read_exr(folder / "a.exr").layers.size(), 3u) << "nothing was changed";
    ForeignFile{.names = {"R", "G", "B", "emission.R", "emission.G", "emission.B"}, .layers = "emission"}.write(
        folder / "b.exr");
    const Image image = read_exr(folder / "b.exr");
    ASSERT_EQ(image.layers.size(), 2u);
    EXPECT_EQ(image.layers[0].pixels[5], Color(311, 411, 511));
    EXPECT_EQ(total(image)[5], ColorD(11, 111, 211));
}

TEST(Exr, RefusesLuminanceAlone) {
    const ScratchFolder folder;
    ForeignFile{.names = {"Y"}}.write(folder / "grey.exr");
    EXPECT_MESSAGE(read_exr(folder / "grey.exr"),
                   "grey.exr: has no channel R; it has: Y (luminance is not read as grey)");
}

TEST(Exr, ReadsThePictureAsOtherProgramsCallIt) {
    using Names = std::vector<std::string>;
    const ScratchFolder folder;
    const std::string layer = "ViewLayer.", pass = "Combined.";
    for (const Names& names :
         {Names{"r", "g", "b", "a"},            // oiiotool
          Names{"red", "green", "blue"},        // the same
          Names{"view.R", "view.G", "view.B"},  // oiiotool --ch
          Names{layer + pass + "R", layer + pass + "G", layer + pass + "B", layer + pass + "A", layer + "Depth.Z",
                layer + "DiffCol.R", layer + "DiffCol.G", layer + "DiffCol.B"}}) {
        ForeignFile{.names = names}.write(folder / "foreign.exr");
        SCOPED_TRACE(names[0]);
        expect_foreign_values(read_exr(folder / "foreign.exr"));
    }
}

TEST(Exr, TakesWhatBlendersCompositorMadeAndSaysSo) {
    const ScratchFolder folder;
    // In front of the channels that are to be read there is another layer's, behind them its own.
    ForeignFile{.names = {"Composite.Combined.R", "Composite.Combined.G", "Composite.Combined.B", "Before.Combined.R",
                          "Before.Combined.G", "Before.Combined.B", "ViewLayer.Combined.R", "ViewLayer.Combined.G",
                          "ViewLayer.Combined.B"}}
        .write(folder / "blender.exr");
    expect_foreign_values(read_exr(folder / "blender.exr"));
    EXPECT_EQ(chosen_picture(folder / "blender.exr"), "Composite.Combined");

    ForeignFile{.names = {"r", "g", "b", "Composite.Combined.R", "Composite.Combined.G", "Composite.Combined.B"}}.write(
        folder / "both.exr");
    expect_foreign_values(read_exr(folder / "both.exr"));
    EXPECT_EQ(chosen_picture(folder / "both.exr"), "") << "what has no layer is the picture";
    ForeignFile{.names = {"ViewLayer.Combined.R", "ViewLayer.Combined.G", "ViewLayer.Combined.B"}}.write(folder /
                                                                                                         "one.exr");
    EXPECT_EQ(chosen_picture(folder / "one.exr"), "");
}

TEST(Exr, RefusesFilesWithoutRgbAndNamesWhatTheyHave) {
    const ScratchFolder folder;
    ForeignFile{.names = {"view.R", "view.G", "view.B", "left.R", "left.G", "left.B"}}.write(folder / "layers.exr");
    EXPECT_MESSAGE(read_exr(folder / "layers.exr"),
                   "has no channel R; it has: left.B, left.G, left.R, view.B, view.G, view.R");
    ForeignFile{
        .names = {"A.Combined.R", "A.Combined.G", "A.Combined.B", "B.Combined.R", "B.Combined.G", "B.Combined.B"}}
        .write(folder / "views.exr");
    EXPECT_MESSAGE(read_exr(folder / "views.exr"), "has no channel R; it has: A.Combined.B");
    ForeignFile{.names = {"direct.R", "direct.G", "direct.B"}, .layers = "emission,direct"}.write(folder / "part.exr");
    EXPECT_MESSAGE(read_exr(folder / "part.exr"), "has no channel R");
}

TEST(Exr, RefusesSubsampledColour) {
    const ScratchFolder folder;
    ForeignFile{.data_window = {{0, 0}, {3, 3}}, .sampling = 2}.write(folder / "subsampled.exr");
    EXPECT_MESSAGE(read_exr(folder / "subsampled.exr"), "subsampled");
}

// Patches the data window of a small file: four little-endian integers behind the attribute's name, type and size.
std::string with_data_window(std::string bytes, std::array<std::int32_t, 4> window) {
    const std::string head("dataWindow\0box2i\0\x10\0\0\0", 21);
    const std::size_t place = bytes.find(head);
    EXPECT_NE(place, std::string::npos);
    std::memcpy(bytes.data() + place + head.size(), window.data(), 16);
    return bytes;
}

TEST(Exr, RefusesAbsurdSizesBeforeAskingForMemory) {
    static_assert(std::endian::native == std::endian::little);
    const ScratchFolder folder;
    write_exr(folder / "small.exr", random_image(4, 4));
    std::ifstream input(folder / "small.exr", std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(input)), std::istreambuf_iterator<char>());
    const std::int32_t most = std::numeric_limits<std::int32_t>::max();
    for (const std::array<std::int32_t, 4>& window : {std::array<std::int32_t, 4>{0, 0, 99'999, 99'999},
                                                      {0, 0, 20'000, 20'000},
                                                      {0, 0, most - 1, most - 1},
                                                      {-most, -most, most, most},
                                                      {0, 0, most, 0},
                                                      {5, 5, 0, 0}}) {
        std::ofstream(folder / "absurd.exr", std::ios::binary) << with_data_window(bytes, window);
        EXPECT_MESSAGE(read_exr(folder / "absurd.exr"), "absurd.exr: ");
    }
}

}  // namespace
}  // namespace photonlab
