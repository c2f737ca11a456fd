// Checkpoints: where the input begins with an odd byte, the rest is the state of a sound checkpoint, with its signature
// and checksum made here, for no mutation would guess the latter; else it is the whole file.

#include "render/checkpoint.h"

#include <optional>
#include <sstream>
#include <vector>

#include "tests/fuzz/fuzz.h"

using namespace photonlab;

namespace {

/// One of each kind of value that an archive can hold.
void exchange_all(StateArchive& archive) {
    std::uint64_t pass = 0;
    std::vector<double> flux;
    std::vector<float> radii(3);
    std::optional<double> radius;
    std::string rows;
    std::vector<std::string> names;
    archive.exchange(pass);
    archive.exchange(radius);
    archive.exchange(flux);
    archive.exchange_as_many(radii);
    archive.exchange(rows);
    archive.exchange_each(names, [](StateArchive& each, std::string& name) { each.exchange(name); });
}

std::string sound_checkpoint(std::string_view state) {
    std::ostringstream stream;
    StateArchive archive(stream);
    for (char c : std::string("photonlab state\n")) archive.exchange(c);
    std::uint32_t format = checkpoint_format;
    std::string identity = "run";
    archive.exchange(format);
    archive.exchange(identity);
    for (char c : state) archive.exchange(c);
    return stream.str() + archive.hash();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view bytes = fuzz::text_of(data, size);
    std::istringstream stream(size > 0 && data[0] % 2 == 1 ? sound_checkpoint(bytes.substr(1)) : std::string(bytes));
    fuzz::read_or_refuse([&] {
        load_checkpoint(stream, "checkpoint", {"checkpoint", "run", "remove it"}, exchange_all);
    });
    return 0;
}
