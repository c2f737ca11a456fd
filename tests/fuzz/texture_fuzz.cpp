// Bitmaps of PNG, which is what scenes here come with: plain ones by libpng, all others by OpenImageIO, whose readers
// of other formats are not ours to fuzz.

#include "image/read_image.h"
#include "tests/fuzz/fuzz.h"

using namespace photonlab;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const fuzz::Folder folder;
    const auto file = folder.write("texture.png", fuzz::text_of(data, size));
    fuzz::read_or_refuse([&] { read_color_image(file, false); });
    return 0;
}
