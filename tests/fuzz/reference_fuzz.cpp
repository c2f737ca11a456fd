// reference.json, and what is read from it without another look.

#include "reference/reference.h"
#include "reference/reference_store.h"
#include "tests/fuzz/fuzz.h"

using namespace photonlab;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const fuzz::Folder folder;
    folder.write("reference.json", fuzz::text_of(data, size));
    fuzz::read_or_refuse([&] { read_reference_json(folder.path()); });
    fuzz::read_or_refuse([&] { check_reference(folder.path(), ReferenceSubject{"0123", 8, 4, 1, -1}); });
    fuzz::read_or_refuse([&] { load_reference(folder.path(), std::nullopt); });
    return 0;
}
