// The meadow command: its options and its report.

#include "commands.hpp"
#include "meadow_job.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace skybark::tool {

namespace {

/// The options as they were typed.
struct meadow_words {
    common_words common;
    std::string out;
    meadow_option_words more;
};

/// Turns words into a job. Errors are those of the command line.
result<void> check_words(const meadow_words& words, meadow_job& job) {
    const auto common = check(words.common);
    if (!common) {
        return failure(common.error());
    }
    if (words.out.empty()) {
        return contradiction("There is no -o OUT; expected a name that ends in .png or .apng.");
    }
    const auto options = check(words.more, words.out);
    if (!options) {
        return failure(options.error());
    }
    if (auto good = check_apart({words.out, common->stats}, "-o and --stats"); !good) {
        return good;
    }
    job.common = *common;
    job.options = *options;
    job.options.what.width = common->width;
    job.options.what.height = common->height;
    job.options.what.seed = common->seed;
    job.out = words.out;
    return {};
}

nlohmann::ordered_json stats_of(const meadow_job& job) {
    auto stats = begin_report("meadow", job);
    stats["counts"] = {{"frames", job.options.frames},
                       {"trees", job.holds.trees},
                       {"segments", job.holds.segments},
                       {"leaves", job.holds.leaves},
                       {"particles", job.holds.particles},
                       {"triangles", job.triangles},
                       {"light_triangles", job.holds.light_triangles},
                       {"light_patches", job.holds.light_patches},
                       {"gather_points", job.holds.gather_points},
                       {"directions", job.options.what.directions},
                       {"bounces", job.options.what.bounces}};
    stats["memory"] = {{"stand", job.holds.stand_bytes},
                       {"clouds", job.holds.cloud_bytes},
                       {"light", job.holds.light_bytes},
                       {"picture", job.holds.picture_bytes}};
    return stats;
}

void summarise(const meadow_job& job) {
    if (job.common.quiet) {
        return;
    }
    std::printf("%s: %llu trees, %llu leaves, %llu triangles, %.2f s on %s (%s)\n", job.out.c_str(),
                static_cast<unsigned long long>(job.holds.trees),
                static_cast<unsigned long long>(job.holds.leaves),
                static_cast<unsigned long long>(job.triangles), job.time.total(),
                name_of(job.common.backend), job.device.c_str());
}

int run_meadow(const meadow_words& words) {
    meadow_job job(words.common.quiet);
    if (auto good = check_words(words, job); !good) {
        return usage_error("meadow", good.error().message);
    }
    const bool numbered = job.options.output == frame_output::numbered;
    auto done = check_writable({numbered ? job.options.name.of(0) : job.out, job.common.stats});
    if (done) {
        done = on_backend(job, make_meadow_on_cpu, make_meadow_on_opengl, make_meadow_on_vulkan);
    }
    job.time.end(); // takes the bar away before a sentence comes
    if (done) {
        done = write_report(job, stats_of(job));
    }
    if (!done) {
        return report_failure(done.error());
    }
    summarise(job);
    return exit_done;
}

} // namespace

command add_meadow_command(CLI::App& to) {
    const auto words = std::make_shared<meadow_words>();
    CLI::App* meadow = to.add_subcommand(
        "meadow", "Draw a meadow: swaying trees, drifting clouds, and the light between them");
    meadow
        ->add_option("-o,--output", words->out,
                     "A picture (.png) or frames (NAME_%04d.png, .apng); required")
        ->type_name("OUT");
    add_meadow_options(*meadow, words->more);
    add_common_options(*meadow, words->common);
    return {"meadow", [words] { return run_meadow(*words); }};
}

} // namespace skybark::tool
