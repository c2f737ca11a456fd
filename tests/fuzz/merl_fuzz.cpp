// MERL tables. A table has 35 million bytes: where the input begins with an odd byte, it is written into a table of
// zeros, its numbers spread over it; else it is the whole file.

#include <cstring>

#include "scene/materials/rough/merl.h"
#include "scene/mitsuba/xml_reader.h"
#include "tests/fuzz/fuzz.h"

using namespace photonlab;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const fuzz::Folder folder;
    std::string bytes(fuzz::text_of(data, size));
    if (size > 0 && data[0] % 2 == 1) {
        bytes.assign(MerlTable::file_size, '\0');
        const std::int32_t dimensions[] = {MerlTable::half_bins, MerlTable::difference_bins, MerlTable::azimuth_bins};
        std::memcpy(bytes.data(), dimensions, sizeof(dimensions));
        std::memcpy(bytes.data(), data + 1, std::min<std::size_t>(size - 1, size % sizeof(dimensions)));
        const std::size_t numbers = size / sizeof(double);
        for (std::size_t i = 0; i < numbers; ++i)
            std::memcpy(bytes.data() + sizeof(dimensions) + i * (3 * MerlTable::bins / numbers) * sizeof(double),
                        data + i * sizeof(double), sizeof(double));
    }
    const auto file = folder.write("table.binary", bytes);
    BytesRead read;
    fuzz::read_or_refuse([&] { load_merl_table(file, "scene.xml:1", read); });
    return 0;
}
