// Experiment files, with a scene beside them to name; whole and as --smoke shrinks them.

#include "experiment/file/experiment_file.h"
#include "tests/fuzz/fuzz.h"

using namespace photonlab;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const fuzz::Folder folder;
    static const auto scene = folder.write("lamp.xml", "<scene/>");
    const auto file = folder.write("experiment.toml", fuzz::text_of(data, size));
    fuzz::read_or_refuse([&] { read_experiment(file); });
    fuzz::read_or_refuse([&] { read_experiment(file, SmokeLimits{}); });
    return 0;
}
