// write_pages FOLDER: writes photonlab.1, photonlab.bash and columns.json there.

#include <fmt/format.h>

#include <cstdio>
#include <exception>

#include "app/commands/commands.h"
#include "app/pages/pages.h"
#include "core/files/files.h"
#include "record/columns.h"

int main(int argc, char** argv) {
    using namespace photonlab;
    try {
        const std::filesystem::path folder = argc > 1 ? argv[1] : ".";
        CLI::App app("photonlab: a research harness for photon mapping", "photonlab");
        add_commands(app);
        write_text_file(folder / "photonlab.1", manual_page(app));
        write_text_file(folder / "photonlab.bash", bash_completion(app));
        write_columns(folder / "columns.json");
        return 0;
    } catch (const std::exception& error) {
        fmt::print(stderr, "write_pages: {}\n", error.what());
        return 1;
    }
}
