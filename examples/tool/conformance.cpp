// The conformance command: the suite on one backend.

#include "commands.hpp"
#include "conformance_backends.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <io/atomic_file.hpp>
#include <io/text_input.hpp>
#include <skybark/conformance/suite.hpp>

namespace skybark::tool {

namespace {

struct conformance_words {
    common_words common;
    std::string filter;
    std::string json;
};

result<void> register_backend(const common_options& options) {
    switch (options.backend) {
    case backend_kind::opengl:
        return register_opengl(options);
    case backend_kind::vulkan:
        return register_vulkan(options);
    default:
        return register_cpu(options);
    }
}

/// A report names cases as BACKEND/PATTERN.CASE: such a name may be given back as it is.
std::string without_backend(const conformance_words& words) {
    const std::string prefix = words.common.backend + "/";
    const bool has = words.filter.substr(0, prefix.size()) == prefix;
    return has ? words.filter.substr(prefix.size()) : words.filter;
}

int run_cases(const conformance_words& words) {
    conformance::options what;
    what.filter = without_backend(words);
    what.quiet = words.common.quiet;
    const bool passed = conformance::run(what) == 0;
    const conformance::session& session = conformance::current_session();
    if (session.results.empty()) {
        return usage_error("conformance", "--filter is " + io::in_quotes(words.filter) +
                                              "; expected a glob such as \"expand.*\" that one "
                                              "case's name matches at least.");
    }
    if (!words.json.empty()) {
        if (auto done = io::write_file(words.json, conformance::to_json(session)); !done) {
            return report_failure(done.error());
        }
    }
    if (!words.common.quiet) {
        std::printf("%zu passed, %zu failed, %zu skipped\n", session.count("passed"),
                    session.count("failed"), session.count("skipped"));
    }
    return passed ? exit_done : exit_failed;
}

int run_conformance(const conformance_words& words) {
    const auto options = check(words.common);
    if (!options) {
        return usage_error("conformance", options.error().message);
    }
    if (!words.json.empty()) {
        if (auto good = io::check_writable(words.json); !good) {
            return report_failure(good.error());
        }
    }
    if (auto registered = register_backend(*options); !registered) {
        return report_failure(registered.error());
    }
    return run_cases(words);
}

} // namespace

command add_conformance_command(CLI::App& to) {
    const auto words = std::make_shared<conformance_words>();
    CLI::App* conformance =
        to.add_subcommand("conformance", "Check that a backend keeps the library's contract");
    add_backend_options(*conformance, words->common);
    conformance->add_option("--filter", words->filter, "Which cases, such as \"expand.*\" (all)")
        ->type_name("GLOB");
    conformance->add_option("--json", words->json, "Write what each case came to as JSON")
        ->type_name("FILE");
    add_quiet(*conformance, words->common);
    return {"conformance", [words] { return run_conformance(*words); }};
}

} // namespace skybark::tool
