#include <fmt/format.h>

#include "app/pages/pages.h"
#include "core/machine/version.h"

namespace photonlab {

namespace {

/// Text as roff takes it: a line that begins with a dot or an apostrophe would be a request, and a bare - a hyphen.
std::string roff(const std::string& text) {
    std::string escaped;
    for (const char c : text) {
        const bool begins_line = escaped.empty() || escaped.back() == '\n';
        if (begins_line && (c == '.' || c == '\'')) escaped += "\\&";
        if (c == '\\')
            escaped += "\\e";
        else if (c == '-')
            escaped += "\\-";
        else
            escaped += c;
    }
    return escaped;
}

bool takes_value(const CLI::Option& option) {
    return option.get_items_expected_max() > 0;
}

std::string paragraph_of(const CLI::Option& option) {
    std::string names;
    for (const std::string& name : option.get_snames()) names += (names.empty() ? "-" : ", -") + name;
    for (const std::string& name : option.get_lnames()) names += (names.empty() ? "--" : ", --") + name;
    if (names.empty())
        names = option.get_name();  // of what is known by its place
    else if (takes_value(option))
        names += " VALUE";
    return fmt::format(".TP\n.B {}\n{}\n", roff(names), roff(option.get_description()));
}

/// A command with its options, those of each group together.
std::string section_of(const CLI::App& command) {
    std::string usage;
    for (const CLI::Option* option : command.get_options())
        if (option->get_positional()) usage += " " + option->get_name();
    std::string text = fmt::format(".SS {}\n.B photonlab {}{} [\\fIoptions\\fR]\n.PP\n{}.\n", roff(command.get_name()),
                                   roff(command.get_name()), roff(usage), roff(command.get_description()));
    for (const std::string& group : command.get_groups())
        for (const CLI::Option* option : command.get_options())
            if (option->get_group() == group && option->get_name() != "--help") text += paragraph_of(*option);
    for (const CLI::Option* option : command.get_options())
        if (option->get_positional() && option->get_group().empty()) text += paragraph_of(*option);
    return text + fmt::format(".PP\n.nf\n{}\n.fi\n", roff(command.get_footer()));
}

}  // namespace

std::string manual_page(const CLI::App& app) {
    std::string text = fmt::format(
        ".TH PHOTONLAB 1 \"\" \"photonlab {}\" \"User Commands\"\n.SH NAME\nphotonlab \\- a research harness for "
        "photon "
        "mapping\n.SH SYNOPSIS\n.B photonlab\n.I command\n[\\fIarguments\\fR]\n.SH DESCRIPTION\nRenders a scene with "
        "photon mapping, with progressive photon mapping and its successors, and by path tracing, over the same hit "
        "points and the same photons, and records after every recorded pass how far each is from a reference. From "
        "those records it draws the plots that papers draw, and says which method is best at which budget.\n.PP\n"
        ".B photonlab new\n.I FOLDER\nwrites a study to begin with.\n.SH COMMANDS\n",
        roff(std::string(program_version().version)));
    for (const CLI::App* command : app.get_subcommands({})) text += section_of(*command);
    return text +
           fmt::format(
               ".SH EXIT STATUS\n.TP\n0\ndone\n.TP\n1\nan error of the program's own\n.TP\n2\ninput that cannot "
               "be used, or files that cannot be written\n.TP\n3\nended by SIGINT or SIGTERM after the pass it "
               "was at, to be continued\n.SH FILES\nIn share/photonlab beside the program's folder: the analysis, "
               "scenes, experiments and their references.\n");
}

}  // namespace photonlab
