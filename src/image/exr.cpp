#include "image/exr.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStdIO.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTestFile.h>
#include <OpenEXR/ImfTileDescription.h>
#include <OpenEXR/ImfVersion.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <optional>
#include <set>
#include <string_view>

#include "core/error.h"
#include "core/files/files.h"
#include "core/hash.h"
#include "core/machine/available_memory.h"
#include "core/text/number_in.h"

namespace photonlab {

namespace {

constexpr const char* layers_attribute = "photonlab.layers";
constexpr const char* total_layer = "total";
constexpr const char* bytes_attribute = "photonlab.bytes";
constexpr const char* checksum_attribute = "photonlab.checksum";
constexpr std::size_t bytes_digits = 20;
constexpr std::size_t checksum_digits = 32;

// A header may claim any size, and memory for it would be asked for before the first pixel is found missing. No
// image here comes near the first limit; the third is above what OpenEXR's compressions reach unless a huge image has
// only one colour.
constexpr std::int64_t largest_pixel_count = std::int64_t{1} << 28;  // of all layers
constexpr std::int64_t largest_block = std::int64_t{1} << 27;        // bytes that OpenEXR decodes at once
constexpr int largest_side = 1 << 24;
constexpr std::int64_t largest_compression_ratio = 10'000;  // pixels of all layers to bytes

// Names to which OpenEXR gives a meaning even where they are strings.
bool is_reserved(const Imf::Header& header, const std::string& name) {
    static const std::set<std::string> reserved = {
        "chunkCount", "maxSamplesPerPixel", "name", "tiles", "type", "version", "view"};
    return header.find(name) != header.end() || reserved.count(name) != 0 || name == layers_attribute;
}

/// The names of three channels that make a colour.
using ColorChannels = std::array<std::string, 3>;

constexpr std::string_view composite_layer = "Composite.Combined";  // of a file that Blender's compositor has gone over

/// "direct.R", "direct.G", "direct.B"; of "" the picture.
ColorChannels channels_of(const std::string& layer) {
    const std::string prefix = layer.empty() ? "" : layer + ".";
    return {prefix + "R", prefix + "G", prefix + "B"};
}

// Slices over a vector of colours that covers the data window from (left, top), one a channel.
void insert_slices(Imf::FrameBuffer& frame, const ColorChannels& names, Color* pixels, int width, int left, int top) {
    static_assert(sizeof(Color) == 3 * sizeof(float));
    const std::size_t pixel_stride = sizeof(Color);
    const std::size_t row_stride = pixel_stride * static_cast<std::size_t>(width);
    for (int channel = 0; channel < 3; ++channel) {
        // OpenEXR addresses pixel (x, y) as base + x * pixel_stride + y * row_stride. For a window away from 0 that
        // base lies outside the vector: computed on integers, as a pointer it would be undefined.
        const auto first = reinterpret_cast<std::uintptr_t>(&pixels[0][channel]);
        const auto base = first - static_cast<std::uintptr_t>(static_cast<std::int64_t>(left)) * pixel_stride -
                          static_cast<std::uintptr_t>(static_cast<std::int64_t>(top)) * row_stride;
        frame.insert(names[static_cast<std::size_t>(channel)],
                     Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(base), pixel_stride, row_stride));
    }
}

std::string channel_names(const Imf::ChannelList& channels) {
    std::string names;
    for (auto channel = channels.begin(); channel != channels.end(); ++channel)
        names += (names.empty() ? "" : ", ") + std::string(channel.name());
    return names;
}

// The layers that the header promises; none in another renderer's file.
std::vector<std::string> promised_layers(const std::string& place, const Imf::Header& header) {
    std::vector<std::string> names;
    const auto* list = header.findTypedAttribute<Imf::StringAttribute>(layers_attribute);
    if (!list) return names;
    std::size_t begin = 0;
    do {
        const std::size_t comma = list->value().find(',', begin);
        names.push_back(list->value().substr(begin, comma - begin));
        begin = comma + 1;
    } while (begin != 0);  // behind the last there is no comma, and npos + 1 is 0
    const std::set<std::string> different(names.begin(), names.end());
    if (different.size() != names.size()) throw InputError(place, "names a layer twice");
    return names;
}

/// True if the three channels are there, with one value a pixel.
bool has_channels(const Imf::ChannelList& channels, const ColorChannels& names) {
    for (const std::string& name : names) {
        const Imf::Channel* channel = channels.findChannel(name);
        if (!channel || channel->xSampling != 1 || channel->ySampling != 1) return false;
    }
    return true;
}

/// Colours as other programs call them: LAYER.R, or LAYER.r, LAYER.red, whether there is a layer or not.
std::vector<ColorChannels> colors_in(const Imf::ChannelList& channels) {
    std::vector<ColorChannels> found;
    for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
        const std::string name = channel.name();
        const std::size_t dot = name.rfind('.');
        const std::string layer = dot == std::string::npos ? "" : name.substr(0, dot + 1);
        for (const ColorChannels& last : {ColorChannels{"R", "G", "B"}, {"r", "g", "b"}, {"red", "green", "blue"}}) {
            const ColorChannels names{layer + last[0], layer + last[1], layer + last[2]};
            if (name == names[0] && has_channels(channels, names)) found.push_back(names);
        }
    }
    return found;
}

/// "ViewLayer.Combined" of the channel ViewLayer.Combined.R; empty of R.
std::string layer_of(const std::string& channel) {
    const std::size_t dot = channel.rfind('.');
    return dot == std::string::npos ? "" : channel.substr(0, dot);
}

/// The colours of Blender's passes "Combined", of one layer or several.
std::vector<ColorChannels> combined_in(const Imf::ChannelList& channels) {
    std::vector<ColorChannels> combined = colors_in(channels);
    std::erase_if(combined, [](const ColorChannels& names) {
        const std::string layer = layer_of(names[0]);
        return layer != "Combined" && !layer.ends_with(".Combined");
    });
    return combined;
}

/// The picture in another program's file: what has no layer's name; in Blender's files what its compositor made, or the
/// pass "Combined" of the only layer that has one; or the only colour that there is. Nothing where that does not tell.
std::optional<ColorChannels> find_picture(const Imf::ChannelList& channels) {
    if (has_channels(channels, channels_of(""))) return channels_of("");
    const std::vector<ColorChannels> colors = colors_in(channels);
    for (const ColorChannels& names : colors)
        if (layer_of(names[0]).empty()) return names;
    const std::vector<ColorChannels> combined = combined_in(channels);
    for (const ColorChannels& names : combined)
        if (layer_of(names[0]) == composite_layer) return names;
    if (combined.size() == 1) return combined[0];
    return colors.size() == 1 ? std::optional(colors[0]) : std::nullopt;
}

/// Says what is missing of three channels, which something is.
[[noreturn]] void refuse_channels(const std::string& place, const Imf::ChannelList& channels,
                                  const ColorChannels& names) {
    for (const std::string& name : names)
        if (!channels.findChannel(name))
            throw InputError(place, "has no channel " + name + "; it has: " + channel_names(channels) +
                                        (channels.findChannel("Y") ? " (luminance is not read as grey)" : ""));
    throw InputError(place, "its channels " + names[0] + ", " + names[1] + ", " + names[2] +
                                " are subsampled; expected one value a pixel");
}

/// Lines that a compression takes together.
std::int64_t lines_at_once(Imf::Compression compression) {
    switch (compression) {
        case Imf::NO_COMPRESSION:
        case Imf::RLE_COMPRESSION:
        case Imf::ZIPS_COMPRESSION:
            return 1;
        case Imf::ZIP_COMPRESSION:
        case Imf::PXR24_COMPRESSION:
            return 16;
        case Imf::PIZ_COMPRESSION:
        case Imf::B44_COMPRESSION:
        case Imf::B44A_COMPRESSION:
        case Imf::DWAA_COMPRESSION:
            return 32;
        default:
            return 256;
    }
}

/// The most that OpenEXR decodes at once, a tile or some lines. It has room for several of them.
std::int64_t block_bytes(const Imf::Header& header, std::int64_t width) {
    std::int64_t pixel_bytes = 0;
    for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel) pixel_bytes += 4;
    if (!header.hasTileDescription()) return width * lines_at_once(header.compression()) * pixel_bytes;
    const Imf::TileDescription& tile = header.tileDescription();
    return tile.xSize > largest_block / std::max(1u, tile.ySize) ? std::numeric_limits<std::int64_t>::max()
                                                                 : std::int64_t{tile.xSize} * tile.ySize * pixel_bytes;
}

Metadata string_attributes(const Imf::Header& header) {
    Metadata metadata;
    for (auto attribute = header.begin(); attribute != header.end(); ++attribute)
        if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&attribute.attribute());
            text && std::strcmp(attribute.name(), layers_attribute) != 0 && std::strcmp(attribute.name(), "type") != 0)
            metadata[attribute.name()] = text->value();
    return metadata;
}

ColorD sum_of_layers(const Image& image, std::size_t pixel) {
    ColorD sum(0.0);
    for (const Layer& layer : image.layers) sum += ColorD(layer.pixels[pixel]);
    return sum;
}

/// What of a file is read.
struct Contents {
    std::vector<std::string> layers;
    std::optional<ColorChannels> picture;
};

/// Everything of ours that is there. Throws InputError when that does not tell the picture, and it is asked for, or
/// when there is nothing.
Contents find_contents(const std::string& place, const Imf::Header& header, const std::string& component) {
    const Imf::ChannelList& channels = header.channels();
    const std::vector<std::string> promised = promised_layers(place, header);
    Contents contents;
    contents.picture = promised.empty()                          ? find_picture(channels)
                       : has_channels(channels, channels_of("")) ? std::optional(channels_of(""))
                                                                 : std::nullopt;
    for (const std::string& name : promised)
        if (has_channels(channels, channels_of(name))) contents.layers.push_back(name);
    const bool is_whole = !promised.empty() && contents.layers.size() == promised.size();
    // Only who asks for a layer by name takes another program's channels for it.
    if (promised.empty() && component != total_layer && has_channels(channels, channels_of(component)))
        contents.layers.push_back(component);
    if (!contents.picture && !is_whole && (component == total_layer || contents.layers.empty()))
        refuse_channels(place, channels, channels_of(component == total_layer ? "" : component));
    return contents;
}

/// True if the picture is what write_exr() makes of these layers.
bool is_rounded_sum(const std::vector<Color>& picture, const Image& image) {
    for (std::size_t i = 0; i < picture.size(); ++i) {
        const Color sum(sum_of_layers(image, i));
        for (int channel = 0; channel < 3; ++channel)
            if (sum[channel] != picture[i][channel] && !(std::isnan(sum[channel]) && std::isnan(picture[i][channel])))
                return false;
    }
    return true;
}

/// Makes the layers those of the picture: where it is not their sum, because another program took some away or changed
/// either, the difference becomes a layer of its own.
void complete(Image& image, std::vector<Color>&& picture) {
    if (image.layers.empty()) {
        image.layers.push_back({total_layer, std::move(picture)});
    } else if (!is_rounded_sum(picture, image)) {
        for (std::size_t i = 0; i < picture.size(); ++i)
            picture[i] = Color(ColorD(picture[i]) - sum_of_layers(image, i));
        image.layers.push_back({"rest", std::move(picture)});
    }
}

Image read_pixels(const std::filesystem::path& file, Metadata* metadata, const std::string& component) {
    const std::string place = file.string();
    // This class reads the header and leaves the memory for pixels to InputPart. Its table of where blocks begin has an
    // entry a line, though.
    Imf::Header::setMaxImageSize(largest_side, largest_side);
    Imf::MultiPartInputFile input(place.c_str(), Imf::globalThreadCount(), false);
    if (input.parts() != 1) throw InputError(place, "has several parts; expected a single image");
    if (Imf::isNonImage(input.version())) throw InputError(place, "holds deep data; expected a flat image");

    const Imf::Header& header = input.header(0);
    const Imath::Box2i window = header.dataWindow();
    const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
    const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
    const std::string size = std::to_string(width) + " x " + std::to_string(height);
    if (width < 1 || height < 1) throw InputError(place, "has an empty data window (" + size + ")");

    const Contents contents = find_contents(place, header, component);
    const auto file_bytes = static_cast<std::int64_t>(size_of_file(file));
    const auto layers = static_cast<std::int64_t>(contents.layers.size() + 1);
    if (width > largest_pixel_count / height || width * height > largest_pixel_count / layers ||
        width * height * layers / largest_compression_ratio > file_bytes)
        throw InputError(place, "claims " + size + " pixels, more than is read here or than its " +
                                    std::to_string(file_bytes) + " bytes can hold");
    if (block_bytes(header, width) > largest_block)
        throw InputError(place, "has too many channels, or tiles too large, for its width of " + std::to_string(width));
    if (!input.partComplete(0)) throw InputError(place, "is incomplete: part of its pixels is missing");

    const std::int64_t read_bytes = width * height * layers * static_cast<std::int64_t>(sizeof(Color));
    require_memory_for(place, static_cast<std::uint64_t>(read_bytes));
    Image image;
    image.width = static_cast<int>(width);
    image.height = static_cast<int>(height);
    const auto pixels = static_cast<std::size_t>(width * height);
    for (const std::string& name : contents.layers) image.layers.push_back({name, std::vector<Color>(pixels)});
    std::vector<Color> picture(contents.picture ? pixels : 0);
    Imf::FrameBuffer frame;
    for (Layer& layer : image.layers)
        insert_slices(frame, channels_of(layer.name), layer.pixels.data(), image.width, window.min.x, window.min.y);
    if (contents.picture)
        insert_slices(frame, *contents.picture, picture.data(), image.width, window.min.x, window.min.y);
    Imf::InputPart part(input, 0);
    part.setFrameBuffer(frame);
    part.readPixels(window.min.y, window.max.y);

    if (contents.picture) complete(image, std::move(picture));
    if (metadata) *metadata = string_attributes(header);
    return image;
}

// total(), pixel by pixel: in double it would be the peak of memory.
std::vector<Color> rounded_total(const Image& image) {
    std::vector<Color> sum(image.layers[0].pixels.size());
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = Color(sum_of_layers(image, i));
    return sum;
}

std::vector<Layer> layers_of(const EstimatedError& error) {
    return {{"estimated_bias", {error.bias.begin(), error.bias.end()}},
            {"estimated_deviation", {error.deviation.begin(), error.deviation.end()}}};
}

// The file in memory: OpenEXR writes its table of offsets in a destructor, where a full disk cannot be reported.
std::string encode(const Image& image, const Metadata& metadata, ExrCompression compression) {
    Imf::Header header(image.width, image.height);
    header.compression() = compression == ExrCompression::Fast ? Imf::RLE_COMPRESSION : Imf::ZIP_COMPRESSION;
    for (const auto& [name, value] : metadata) {
        if (is_reserved(header, name)) throw InputError("metadata cannot be called \"" + name + "\": OpenEXR uses it");
        header.insert(name, Imf::StringAttribute(value));
    }

    const bool layered = image.layers.size() != 1 || image.layers[0].name != total_layer;
    std::vector<Layer> layers;
    std::string names;
    if (layered)
        for (const Layer& layer : image.layers) names += (names.empty() ? "" : ",") + layer.name;
    if (layered) header.insert(layers_attribute, Imf::StringAttribute(names));

    const std::vector<Color> sum = layered ? rounded_total(image) : std::vector<Color>{};

    Imf::FrameBuffer frame;
    const auto add = [&](const std::string& name, const std::vector<Color>& pixels) {
        for (const std::string& channel : channels_of(name))
            header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
        // OpenEXR's slices are not const, though writing a file only reads them.
        insert_slices(frame, channels_of(name), const_cast<Color*>(pixels.data()), image.width, 0, 0);
    };
    add("", layered ? sum : image.layers[0].pixels);
    if (layered)
        for (const Layer& layer : image.layers) add(layer.name, layer.pixels);
    std::vector<Layer> estimates;
    if (image.estimated_error) estimates = layers_of(*image.estimated_error);
    for (const Layer& layer : estimates) add(layer.name, layer.pixels);
    for (const auto& [name, values] :
         {std::pair{"radius", &image.radius}, {"count", &image.count}, {"density", &image.density}}) {
        if (values->empty()) continue;
        header.channels().insert(name, Imf::Channel(Imf::FLOAT));
        frame.insert(name, Imf::Slice::Make(Imf::FLOAT, values->data(), header.dataWindow()));
    }

    Imf::StdOSStream stream;
    {
        Imf::OutputFile output(stream, header);
        output.setFrameBuffer(frame);
        output.writePixels(image.height);
    }
    return stream.str();
}

std::string encode_for(const std::filesystem::path& file, const Image& image, const Metadata& metadata,
                       ExrCompression compression) {
    assert(image.width > 0 && image.height > 0 && !image.layers.empty());
    for (const Layer& layer : image.layers) {
        assert(layer.pixels.size() == static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
        assert(!layer.name.empty() && layer.name.find_first_of(",.") == std::string::npos);
        static_cast<void>(layer);  // for builds without assertions
    }
    try {
        return encode(image, metadata, compression);
    } catch (const std::exception& error) {
        throw InputError(file.string(), std::string("cannot be written: ") + error.what());
    }
}

/// Where the value of a string attribute begins in a file; npos when it has none of the name.
std::size_t value_position(std::string_view bytes, const std::string& attribute) {
    const std::string start = attribute + '\0' + "string" + '\0';
    const std::size_t found = bytes.find(start);
    return found == std::string::npos ? found : found + start.size() + sizeof(std::uint32_t);  // its length is between
}

}  // namespace

void write_exr(const std::filesystem::path& file, const Image& image, const Metadata& metadata,
               ExrCompression compression) {
    write_text_file(file, encode_for(file, image, metadata, compression));
}

void write_sealed_exr(const std::filesystem::path& file, const Image& image, const Metadata& metadata) {
    Metadata sealed = metadata;
    sealed[bytes_attribute] = std::string(bytes_digits, '0');
    sealed[checksum_attribute] = std::string(checksum_digits, '0');
    std::string bytes = encode_for(file, image, sealed, ExrCompression::Fast);
    bytes.replace(value_position(bytes, bytes_attribute), bytes_digits, fmt::format("{:020}", bytes.size()));
    bytes.replace(value_position(bytes, checksum_attribute), checksum_digits, hash_text(bytes));
    write_text_file(file, bytes);
}

namespace {

/// Refuses a header whose attributes claim more bytes than the file has: OpenEXR asks for memory for them, up to 2 GiB,
/// before it reads them. What else may be wrong with it OpenEXR finds itself.
void require_attributes_within(const std::filesystem::path& path) {
    const std::uint64_t file_bytes = size_of_file(path);
    std::ifstream file(path, std::ios::binary);
    file.seekg(8);  // the magic number and the version
    const auto skip_text = [&] {
        for (char character = 0; file.get(character) && character != 0;) {
        }
    };
    while (file && file.peek() > 0) {
        skip_text();  // the attribute's name
        skip_text();  // and its type
        std::uint32_t bytes = 0;
        for (unsigned shift = 0; shift < 32; shift += 8)
            bytes |= static_cast<std::uint32_t>(static_cast<unsigned char>(file.get())) << shift;
        if (!file) return;
        if (bytes > file_bytes - static_cast<std::uint64_t>(file.tellg()))
            throw InputError(path.string(), "is broken: an attribute of its header claims " + std::to_string(bytes) +
                                                " bytes, more than follow");
        file.seekg(bytes, std::ios::cur);
    }
}

/// Refuses what is not an OpenEXR file, and turns OpenEXR's own exceptions into InputErrors.
template <typename Read>
auto read_checked(const std::filesystem::path& file, const Read& read) {
    const std::string place = file.string();
    require_ordinary_file(file);
    if (!Imf::isOpenExrFile(place.c_str())) throw InputError(place, "is not an OpenEXR file");
    require_attributes_within(file);
    try {
        return read();
    } catch (const InputError&) {
        throw;
    } catch (const std::exception& error) {
        throw InputError(place, std::string("cannot be read as OpenEXR: ") + error.what());
    }
}

}  // namespace

std::string chosen_picture(const std::filesystem::path& file) {
    return read_checked(file, [&] {
        const Imf::MultiPartInputFile input(file.c_str(), 0, false);
        const Imf::ChannelList& channels = input.header(0).channels();
        const auto picture = find_picture(channels);
        const bool is_choice =
            picture && layer_of((*picture)[0]) == composite_layer && combined_in(channels).size() > 1;
        return std::string(is_choice ? composite_layer : "");
    });
}

Image read_exr(const std::filesystem::path& file, Metadata* metadata, const std::string& component) {
    return read_checked(file, [&] { return read_pixels(file, metadata, component); });
}

Metadata read_exr_metadata(const std::filesystem::path& file) {
    return read_checked(file,
                        [&] { return string_attributes(Imf::MultiPartInputFile(file.c_str(), 0, false).header(0)); });
}

Metadata read_sealed_metadata(const std::filesystem::path& file) {
    Metadata metadata = read_exr_metadata(file);
    const auto bytes = number_in<std::uintmax_t>(metadata[bytes_attribute]);
    if (!bytes || metadata[checksum_attribute].size() != checksum_digits)
        throw InputError(file.string(), "does not say how long it is and what its checksum is");
    const std::uintmax_t size = size_of_file(file);
    if (size != *bytes)
        throw InputError(file.string(), fmt::format("has {} bytes, and had {} when it was written", size, *bytes));
    return metadata;
}

void require_seal(const std::filesystem::path& file) {
    require_ordinary_file(file);
    std::ifstream stream(file, std::ios::binary);
    constexpr std::uintmax_t most_at_once = std::uintmax_t{1} << 24;  // bytes; the header is in the first
    std::string piece(std::min(size_of_file(file), most_at_once) + 1, '\0');
    std::string stored;
    RunningHash hash;
    while (stream.read(piece.data(), static_cast<std::streamsize>(piece.size())) || stream.gcount() > 0) {
        const auto size = static_cast<std::size_t>(stream.gcount());
        if (stored.empty()) {
            const std::size_t position = value_position(std::string_view(piece).substr(0, size), checksum_attribute);
            if (position > size || size - position < checksum_digits) break;
            stored = piece.substr(position, checksum_digits);
            piece.replace(position, checksum_digits, checksum_digits, '0');
        }
        hash.add(piece.data(), size);
    }
    if (stored.empty() || stored != hash.text())
        throw InputError(file.string(), "is not what was written: its checksum is another");
}

}  // namespace photonlab
