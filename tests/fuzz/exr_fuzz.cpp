// OpenEXR files as references and results are read.

#include "image/exr.h"
#include "tests/fuzz/fuzz.h"

using namespace photonlab;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const fuzz::Folder folder;
    const auto file = folder.write("image.exr", fuzz::text_of(data, size));
    Metadata metadata;
    fuzz::read_or_refuse([&] { read_exr(file, &metadata); });
    fuzz::read_or_refuse([&] { read_exr_metadata(file); });
    return 0;
}
