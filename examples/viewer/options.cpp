#include "options.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <io/text_input.hpp>

namespace skybark::viewer {

namespace {

/// Light bounces this often at most, unless --bounces says otherwise.
constexpr std::uint32_t usual_most_bounces = 4;

struct all_words {
    tool::common_words common;
    tool::meadow_option_words scene;
    bool headless = false;
    bool checked = false;
    std::optional<std::string> script;
};

void describe(CLI::App& app, all_words& words) {
    words.common.backend = "opengl";
    words.common.size = "1280x720";
    app.add_option("--backend", words.common.backend, "What draws: opengl or vulkan (opengl)")
        ->type_name("B");
    app.add_option("--size", words.common.size, "Pixels of the picture (1280x720)")
        ->type_name("WxH");
    app.add_option("--seed", words.common.seed, "Of what is random (1)")->type_name("N");
    app.add_option("--script", words.script, "Do what it says instead of mouse and keyboard")
        ->type_name("FILE");
    app.add_flag("--headless", words.headless, "Show no window; needs --script");
    app.add_flag("--check", words.checked,
                 "Turn on the driver's own checks; fail where they have anything to say");
    tool::add_scene_options(app, words.scene);
    app.set_version_flag("--version", SKYBARK_VERSION);
}

result<options> check(const all_words& words) {
    options made;
    const auto common = tool::check(words.common);
    if (!common) {
        return failure(common.error());
    }
    if (common->backend == tool::backend_kind::cpu) {
        return fail(error_code::bad_input, "--backend is \"cpu\"; expected opengl or vulkan.");
    }
    tool::meadow_option_words scene_words = words.scene;
    if (!scene_words.supersampling) {
        scene_words.supersampling = "1";
    }
    const auto scene = tool::check_scene(scene_words);
    if (!scene) {
        return failure(scene.error());
    }
    if (words.headless && !words.script) {
        return fail(error_code::bad_input, "--headless needs a --script that says what to do.");
    }
    made.backend = common->backend;
    made.scene = *scene;
    made.scene.what.width = common->width;
    made.scene.what.height = common->height;
    made.scene.what.seed = common->seed;
    if (!words.scene.bounces) {
        made.scene.what.bounces = usual_most_bounces;
    }
    made.screen = {common->width, common->height, words.headless, words.script.has_value(),
                   nullptr};
    made.checked = words.checked;
    return made;
}

/// Reads the script, if there is one.
result<void> add_script(const all_words& words, options& to) {
    if (!words.script) {
        return {};
    }
    const auto text = io::load_text(*words.script);
    if (!text) {
        return failure(text.error());
    }
    auto steps = read_script(*words.script, *text);
    if (!steps) {
        return failure(steps.error());
    }
    to.script = std::move(*steps);
    return {};
}

} // namespace

void complain(std::string_view sentence) {
    std::fprintf(stderr, "skybark_viewer: %.*s\n", static_cast<int>(sentence.size()),
                 sentence.data());
}

asked read_options(int count, char** given) {
    const auto usage_error = [](std::string_view sentence) {
        complain(sentence);
        std::fputs("'skybark_viewer --help' tells more.\n", stderr);
        return asked{{}, tool::exit_usage};
    };
    CLI::App app("Shows a meadow: trees that sway, clouds and their shadows, light that bounces.\n"
                 "Left button: orbit. Middle: pan. Wheel: zoom. Space pauses, R resets, H hides "
                 "the panel, F12 saves a picture, Esc quits.",
                 "skybark_viewer");
    all_words words;
    describe(app, words);
    try {
        app.parse(count, given);
    } catch (const CLI::Success& done) { // --help, --version
        return {{}, app.exit(done)};
    } catch (const CLI::ParseError& wrong) {
        return usage_error(wrong.what());
    }
    auto made = check(words);
    if (!made) {
        return usage_error(made.error().message);
    }
    if (auto done = add_script(words, *made); !done) {
        complain(done.error().message);
        return {{}, tool::exit_failed};
    }
    return {std::move(*made), tool::exit_done};
}

} // namespace skybark::viewer
