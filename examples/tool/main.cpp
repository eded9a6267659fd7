// skybark: the command-line tool.

#include "commands.hpp"
#include "options.hpp"

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <io/atomic_file.hpp>
#include <io/text_input.hpp>
#include <unistd.h>

namespace skybark::tool {

namespace {

/// Whoever stops the tool finds no half of a file.
void stop(int signal) {
    io::remove_unfinished();
    std::signal(signal, SIG_DFL);
    std::raise(signal);
}

void handle_signals() {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        if (std::signal(signal, stop) == SIG_IGN) {
            std::signal(signal, SIG_IGN); // as under nohup
        }
    }
    std::signal(SIGPIPE, SIG_IGN); // a closed pipe is an error of the write, with a sentence
    std::signal(SIGXFSZ, SIG_IGN); // and so is a file that grows too long
}

/// What the parser has to say, as a sentence.
std::string sentence(std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    if (!text.empty() && text.back() != '.') {
        text += '.';
    }
    return text;
}

bool is_known(const std::vector<command>& commands, const std::string& name) {
    return std::any_of(commands.begin(), commands.end(),
                       [&](const command& c) { return c.name == name; });
}

int run(int count, char** words) {
    CLI::App app{"GPU algorithms for natural scenes: tries them out, and writes what they make.",
                 "skybark"};
    app.set_version_flag("--version", std::string("skybark ") + SKYBARK_VERSION);
    std::vector<command> commands{add_tree_command(app),    add_cloud_command(app),
                                  add_gather_command(app),  add_meadow_command(app),
                                  add_devices_command(app), add_conformance_command(app)};
    app.require_subcommand(0, 1);
    for (CLI::App* sub : app.get_subcommands({})) {
        sub->set_version_flag("--version", std::string("skybark ") + SKYBARK_VERSION);
    }
    if (count < 2) {
        std::fputs(app.help().c_str(), stderr);
        return exit_usage;
    }
    const std::string first = words[1];
    if (first.substr(0, 1) != "-" && !is_known(commands, first)) {
        return usage_error("",
                           "There is no command " + io::in_quotes(first) +
                               "; expected tree, cloud, gather, meadow, devices or conformance.");
    }
    try {
        app.parse(count, words);
    } catch (const CLI::ParseError& e) {
        if (e.get_exit_code() == 0) {
            return app.exit(e); // --help, --version
        }
        return usage_error(is_known(commands, first) ? first : "", sentence(e.what()));
    }
    for (const command& c : commands) {
        if (app.got_subcommand(c.name)) {
            return c.run();
        }
    }
    return usage_error(
        "", "There is no command; expected tree, cloud, gather, meadow, devices or conformance.");
}

} // namespace

} // namespace skybark::tool

int main(int count, char** words) {
    using namespace skybark::tool;
    try {
        handle_signals();
        const int code = run(count, words);
        if (std::fflush(stdout) != 0) {
            complain("The output can't be written.");
            return code == exit_done ? exit_failed : code;
        }
        return code;
    } catch (const std::bad_alloc&) {
        complain("There is not enough memory.");
    } catch (const std::exception& e) {
        complain(e.what());
    }
    return exit_failed;
}
