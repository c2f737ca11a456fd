// photonlab analyse and photonlab figure: the analysis, which is a Python program of its own and reads its own options.
// What is here finds a Python for it. The first python3 on the PATH may be one without the libraries, so that
// /usr/bin/python3 is asked first, whose packages the Debian package brings, and then every other.

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "app/commands/commands.h"
#include "app/installed.h"
#include "core/error.h"
#include "core/files/files.h"
#include "core/text/messages.h"

namespace photonlab {

namespace {

constexpr std::string_view analyse_command = "analyse";
constexpr std::string_view figure_command = "figure";

/// Prints the version and those modules that are not there, whatever lies in the current folder. Nothing is imported,
/// which takes seconds.
constexpr const char* question =
    "import sys; sys.path = [p for p in sys.path if p]; import importlib.util as u, platform; "
    "print(platform.python_version(), *[m for m in 'numpy scipy pandas matplotlib xxhash OpenImageIO skimage'.split() "
    "if not u.find_spec(m)])";

/// In Debian they are called python3-NAME.
std::string package_of(std::string module) {
    std::transform(module.begin(), module.end(), module.begin(), [](unsigned char c) { return std::tolower(c); });
    return "python3-" + module;
}

struct Interpreter {
    std::string file;
    std::string version;             ///< empty: it does not run
    std::vector<std::string> lacks;  ///< modules
};

/// The first line that a program prints.
std::string first_line_of(const std::vector<std::string>& words) {
    std::string command;
    for (const std::string& word : words) {
        std::string quoted = word;
        for (std::size_t at = 0; (at = quoted.find('\'', at)) != std::string::npos; at += 4)
            quoted.replace(at, 1, "'\\''");
        command += "'" + quoted + "' ";
    }
    std::FILE* pipe = ::popen((command + "2>/dev/null").c_str(), "r");
    if (!pipe) return "";
    std::array<char, 512> line{};
    const bool has_line = std::fgets(line.data(), line.size(), pipe) != nullptr;
    return ::pclose(pipe) == 0 && has_line ? line.data() : "";
}

Interpreter ask(const std::string& file) {
    Interpreter python{file, "", {}};
    std::istringstream words(first_line_of({file, "-c", question}));
    words >> python.version;
    for (std::string module; words >> module;) python.lacks.push_back(module);
    return python;
}

/// /usr/bin/python3, and every python3 on the PATH.
std::vector<std::string> candidates() {
    std::vector<std::string> files{"/usr/bin/python3"};
    const char* path = std::getenv("PATH");
    std::istringstream folders(path ? path : "");
    for (std::string folder; std::getline(folders, folder, ':');)
        if (const std::string file = folder + "/python3"; std::find(files.begin(), files.end(), file) == files.end())
            files.push_back(file);
    std::erase_if(files, [](const std::string& file) { return ::access(file.c_str(), X_OK) != 0; });
    return files;
}

Interpreter find_python() {
    std::vector<std::string> found;
    std::vector<std::string> packages;
    for (const std::string& file : candidates()) {
        Interpreter python = ask(file);
        if (!python.version.empty() && python.lacks.empty()) return python;
        if (python.version.empty()) continue;
        found.push_back(fmt::format("{} has no {}", file, fmt::join(python.lacks, ", ")));
        if (!packages.empty()) continue;
        for (const std::string& module : python.lacks) packages.push_back(package_of(module));
    }
    if (found.empty()) throw InputError("the analysis: expected python3 in /usr/bin or on the PATH");
    throw InputError(fmt::format("the analysis: expected a python3 with its libraries; {} (Debian: apt install {})",
                                 fmt::join(found, "; "), fmt::join(packages, " ")));
}

}  // namespace

bool are_for_analysis(const std::vector<std::string>& words) {
    const bool is_named = words[0] == analyse_command || words[0] == figure_command;
    return is_named && !(words.size() > 1 && (words[1] == "--help" || words[1] == "-h"));
}

void start_analysis(const std::vector<std::string>& words) {
    const Interpreter python = find_python();
    print_message("photonlab: the analysis runs in {} (Python {})\n", python.file, python.version);
    std::vector<std::string> line{python.file, installed_folder("analysis").string()};
    line.insert(line.end(), words.begin(), words.end());
    std::vector<char*> pointers;
    for (std::string& word : line) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    ::execv(pointers[0], pointers.data());
    throw std::system_error(errno, std::generic_category(), python.file);
}

std::vector<std::string> kinds_of_figures() {
    std::vector<std::string> kinds;
    for (const std::filesystem::path& file : files_below(installed_folder("analysis") / "photonlab" / "figures"))
        if (file.extension() == ".py" && file.stem() != "__init__") kinds.push_back(file.stem().string());
    std::sort(kinds.begin(), kinds.end());
    return kinds;
}

void add_analysis_commands(CLI::App& app) {
    CLI::App* analyse = app.add_subcommand(
        std::string(analyse_command), "Draw what a results folder has, and say which method is best at which budget");
    analyse->add_option("RESULTS", "folder of an experiment's results")->required()->type_name("");
    analyse->footer(
        "What is there already, of the same records, is not made again. RESULTS/report.html is the page to send.\n"
        "photonlab analyse COMMAND RESULTS does one thing of it: answer, table, metrics, report, decomposition, fits;\n"
        "COMMAND --help says what its options are. It runs in a Python with numpy, scipy, pandas, matplotlib, xxhash,\n"
        "OpenImageIO and skimage, which the program looks for and names.\n\n"
        "Example:\n  photonlab analyse results/demo\n  photonlab analyse answer results/demo --seconds 10");
    CLI::App* figure = app.add_subcommand(std::string(figure_command), "Draw one figure of a results folder");
    figure->add_option("KIND", "what is drawn: see below")->required()->type_name("");
    figure->add_option("RESULTS", "folder of an experiment's results")->required()->type_name("");
    figure->footer("");  // not that of all commands behind it
    figure->footer([] {
        return fmt::format(
            "Kinds: {}.\nphotonlab figure KIND --help says what it shows and what its options are.\n\n"
            "Example:\n  photonlab figure convergence results/demo --width 84mm --no-caption --format pdf",
            fmt::join(kinds_of_figures(), ", "));
    });
}

}  // namespace photonlab
