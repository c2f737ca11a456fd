// Results folders: where the input begins with an odd byte, the rest is the text of a JSON object, sealed here with the
// checksum that no mutation would guess; else it is the whole file. It is tried as run.json, merged.json and
// ensemble.json of a folder that holds a run's rows.

#include "core/files/kept_files.h"
#include "experiment/verify_results.h"
#include "record/merged_records.h"
#include "record/recorder.h"
#include "record/run/run_record.h"
#include "tests/fuzz/fuzz.h"

using namespace photonlab;

namespace {

/// `text` with the checksum that kept_files.h describes, if it is an object.
std::string sealed(std::string_view text) {
    const std::optional<Json> json = parse_sound_json(std::string(text));
    return json && json->is_object() && !json->empty() ? with_checksum(*json) : std::string(text);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const fuzz::Folder folder;
    const std::string_view bytes = fuzz::text_of(data, size);
    const std::string text = size > 0 && data[0] % 2 == 1 ? sealed(bytes.substr(1)) : std::string(bytes);
    const std::filesystem::path results = folder.path() / "results";
    std::filesystem::create_directories(results / "runs/r");
    std::filesystem::create_directories(results / "ensembles/r");
    folder.write("results/runs/r/iterations.csv", csv_header() + "\n");
    folder.write("results/iterations.csv", csv_header() + "\n");
    for (const char* name : {"runs/r/run.json", "merged.json", "ensembles/r/ensemble.json"}) {
        folder.write("results/" + std::string(name), text);
        fuzz::read_or_refuse([&] { verify_results(results); });
        fuzz::read_or_refuse([&] { read_merged_files(results); });
        fuzz::read_or_refuse([&] {
            if (const auto run = read_finished_run(results / "runs/r")) {
                faults_of(results / "runs/r", *run, Check::Records);
                merge_records(run->experiment, results, {{results / "runs/r", run->key}});
            }
        });
        std::filesystem::remove(results / name);
    }
    return 0;
}
