// The target `manual`: brings the tables of docs/manual.md up to date.

#include "core/files/files.h"
#include "tests/support/manual_tables.h"

int main() {
    const std::filesystem::path page = PHOTONLAB_SOURCE_DIR "/docs/manual.md";
    photonlab::write_text_file(page, photonlab::with_tables(photonlab::read_text_file(page)));
}
