// The options of `skybark cloud`: words into numbers, and sentences about the rest.

#include <tool/cloud_options.hpp>

#include <CLI/CLI.hpp>
#include <gtest/gtest.h>
#include <initializer_list>
#include <random>
#include <string>
#include <vector>

using namespace skybark::tool;
using namespace skybark::clouds;

namespace {

using words = std::vector<std::string>;

const cloud_option_context to_picture{"a.csv", "a.png"};
const cloud_option_context of_grid{"a.vdb", "a.png"};

/// Reads a command line by the same parser as the tool.
cloud_option_words parsed(words arguments) {
    CLI::App app;
    cloud_option_words typed;
    add_cloud_options(app, typed);
    std::reverse(arguments.begin(), arguments.end()); // as CLI11 wants a vector
    EXPECT_NO_THROW(app.parse(arguments));
    return typed;
}

skybark::result<cloud_options> checked(words arguments, const cloud_option_context& context) {
    return check(parsed(std::move(arguments)), context);
}

cloud_options accepted(words arguments, const cloud_option_context& context = to_picture) {
    const auto options = checked(std::move(arguments), context);
    EXPECT_TRUE(options) << options.error().message;
    return options.value_or(cloud_options{});
}

void expect_refused(words arguments, std::initializer_list<const char*> parts,
                    const cloud_option_context& context = to_picture) {
    const std::string first = arguments.empty() ? "" : arguments[0];
    const auto options = checked(std::move(arguments), context);
    ASSERT_FALSE(options) << first;
    const std::string& message = options.error().message;
    for (const char* part : parts) {
        EXPECT_NE(message.find(part), std::string::npos) << message << " lacks " << part;
    }
    EXPECT_NE(message.find("expected"), std::string::npos) << message;
    EXPECT_EQ(message.back(), '.');
}

/// With = a value may begin with a minus, and without it may be empty.
words typed(const std::string& option, const std::string& value) {
    return value.empty() ? words{option, ""} : words{option + "=" + value};
}

} // namespace

TEST(cloud_options, are_what_the_manual_says) {
    const cloud_options options = accepted({});
    EXPECT_EQ(options.source, cloud_source::table);
    EXPECT_EQ(options.output, cloud_output::picture);
    EXPECT_EQ(options.volume, 128u);
    EXPECT_EQ(options.method, cloud_method::impulse_scan);
    EXPECT_EQ(options.light, cloud_light::continuum);
    EXPECT_EQ(options.attenuation.method, attenuation_method::impulse_scan);
    EXPECT_EQ(options.attenuation.profile, attenuation_profile::erf);
    EXPECT_EQ(options.attenuation.format, skybark::volume_format::float32);
    EXPECT_EQ(options.attenuation.sigmas, 3);
    // The mean cosine of droplets 10 µm across is 0.864 (Jendersie and d'Eon).
    EXPECT_NEAR(options.phase.mean_cosine(), 0.864, 1e-3);
    EXPECT_EQ(options.extinction, 1);
    EXPECT_EQ(options.albedo, 1);
    EXPECT_EQ(options.probe, "");
}

TEST(cloud_options, are_what_was_typed) {
    const cloud_options options = accepted(
        {"--sun",     "-30,89.5",   "--volume",   "256",     "--method",  "shadow_polygons",
         "--padding", "degenerate", "--polygons", "stage",   "--route",   "tiles_copied",
         "--profile", "step",       "--light",    "octaves", "--octaves", "5",
         "--phase",   "hg:-0.5",    "--sigmas",   "2.5",     "--half",    "--camera",
         "1,2,3",     "--look-at",  "4,5,6"});
    EXPECT_EQ(options.sun_azimuth, -30);
    EXPECT_EQ(options.sun_elevation, 89.5);
    EXPECT_EQ(options.volume, 256u);
    EXPECT_EQ(options.attenuation.method, attenuation_method::shadow_polygons);
    EXPECT_EQ(options.attenuation.policy, skybark::padding::degenerate);
    EXPECT_EQ(options.attenuation.polygons, polygon_source::stage);
    EXPECT_EQ(options.attenuation.route, skybark::accumulate_route::tiles_copied);
    EXPECT_EQ(options.attenuation.profile, attenuation_profile::step);
    EXPECT_EQ(options.light, cloud_light::octaves);
    EXPECT_EQ(options.octaves, 5u);
    EXPECT_DOUBLE_EQ(options.phase.mean_cosine(), -0.5);
    EXPECT_EQ(options.attenuation.sigmas, 2.5f);
    EXPECT_EQ(options.attenuation.format, skybark::volume_format::float16);
    EXPECT_EQ(*options.camera.eye, glm::vec3(1, 2, 3));
    EXPECT_EQ(*options.camera.target, glm::vec3(4, 5, 6));
    const cloud_options grid =
        accepted({"--extinction", "0.045", "--albedo", "0.9", "--grid", "smoke"}, of_grid);
    EXPECT_EQ(grid.grid, "smoke");
    EXPECT_EQ(grid.source, cloud_source::grid);
    EXPECT_EQ(grid.extinction, 0.045f);
    EXPECT_EQ(grid.albedo, 0.9f);
    EXPECT_EQ(accepted({"--particles", "7"}, {"cumulus", "a.png"}).particles, 7u);
    for (const char* cloud : {"cumulus", "cumulus_field"}) { // as many as the library makes
        EXPECT_EQ(accepted({"--particles", "4194304"}, {cloud, "a.png"}).particles, 1u << 22);
        expect_refused({"--particles", "4194305"}, {"--particles", "4194304"}, {cloud, "a.png"});
    }
}

TEST(cloud_options, know_phase_functions) {
    EXPECT_DOUBLE_EQ(accepted({"--phase", "isotropic"}).phase(0.3), 1 / (4 * std::acos(-1.0)));
    EXPECT_DOUBLE_EQ(accepted({"--phase", "hg:0.85"}).phase.mean_cosine(), 0.85);
    // Rayleigh's: 3/16π (1 + u²).
    const double rayleigh = 3 / (16 * std::acos(-1.0)) * (1 + 0.25);
    EXPECT_NEAR(accepted({"--phase", "draine:0,1"}).phase(0.5), rayleigh, 1e-12);
    EXPECT_NEAR(accepted({"--light", "product"}).phase(0.5), rayleigh, 1e-12) << "by itself";
    EXPECT_NEAR(accepted({"--method", "harris"}).phase(0.5), rayleigh, 1e-12);
    EXPECT_GT(accepted({"--phase", "mie:20"}).phase.mean_cosine(), 0.86);
    for (const char* bad : {"", "mie", "mie:", "mie:4.9", "mie:51", "mie:nan", "mie:10,1", "hg",
                            "hg:1", "hg:-1", "hg:x", "hg:0.5,1", "draine:0.5", "draine:0.5,-1",
                            "draine:2,1", "draine:0,1,2", "Mie:10", "isotropic:1", "rayleigh"}) {
        expect_refused(typed("--phase", bad), {"--phase", bad, "mie:D"});
    }
}

TEST(cloud_options, know_the_sun) {
    const cloud_option_context to_volume{"a.csv", "a.vdb"};
    EXPECT_EQ(accepted({"--sun=0,-90"}, to_volume).sun_elevation, -90);
    EXPECT_EQ(accepted({"--sun=360,90"}).sun_azimuth, 360);
    for (const char* bad : {"", "120", "120,50,1", "120;50", "nan,50", "120,nan", "inf,0", "361,0",
                            "0,91", "0,-91", "east,50", "120,", ",50", " 120,50"}) {
        expect_refused(typed("--sun", bad), {"--sun", bad, "AZIMUTH,ELEVATION"}, to_volume);
    }
    expect_refused({"--sun=0,-1"}, {"--sun", "from 0 to 90"});
}

TEST(cloud_options, refuse_numbers_that_are_none) {
    const words none{"", "nan", "inf", "-inf", "1e400", "x", "1x", " 1", "0x1", "1,5", "--"};
    const std::pair<const char*, words> all[] = {
        {"--volume", {"0", "-1", "3", "1.5", "65537", "100000", "99999999999999999999"}},
        {"--sigmas", {"0", "-1", "9.1"}},
        {"--extinction", {"-0.001", "1e7"}},
        {"--albedo", {"-0.001", "1.001"}},
        {"--octaves", {"0", "-1", "33", "2.5"}},
        {"--particles", {"0", "-1", "4194305", "2.5"}},
    };
    for (const auto& [option, own] : all) {
        for (const words& values : {none, own}) {
            for (const std::string& value : values) {
                const words arguments =
                    value.empty() ? words{option, ""} : words{std::string(option) + "=" + value};
                expect_refused(arguments, {option, ("\"" + value + "\"").c_str()}, of_grid);
            }
        }
    }
}

TEST(cloud_options, refuse_names_that_they_do_not_know) {
    for (const char* option :
         {"--method", "--padding", "--polygons", "--route", "--profile", "--light"}) {
        for (const char* value : {"", "none", "ERF", "impulse"}) {
            expect_refused({option, value}, {option, value});
        }
    }
}

TEST(cloud_options, refuse_what_contradicts_itself) {
    expect_refused({"--route", "layers"}, {"--route", "--method shadow_polygons"});
    expect_refused({"--polygons", "stage"}, {"--polygons", "--method shadow_polygons"});
    expect_refused({"--octaves", "3"}, {"--octaves", "--light octaves"});
    expect_refused({"--method", "harris", "--light", "continuum"}, {"--method harris", "product"});
    expect_refused({"--method", "harris", "--profile", "erf"}, {"harris", "--profile"});
    expect_refused({"--method", "harris", "--half"}, {"harris", "--half"});
    expect_refused({"--method", "harris"}, {"harris", ".png"}, {"a.csv", "a.vdb"});
    EXPECT_EQ(accepted({"--method", "harris", "--light", "product"}).light, cloud_light::product);
    EXPECT_EQ(accepted({"--method", "harris"}).light, cloud_light::product);
    expect_refused({"--padding", "compact"}, {"--padding", "--method shadow_polygons"});
    expect_refused({"--extinction", "2"}, {"--extinction", ".vdb"});
    expect_refused({"--albedo", "1"}, {"--albedo", ".vdb"});
    expect_refused({"--particles", "9"}, {"--particles", "cumulus"});
    expect_refused({"--particles", "9"}, {"--particles", "cumulus"}, of_grid);
    expect_refused({"--light", "product"}, {"density", "continuum"}, of_grid);
    expect_refused({"--method", "shadow_polygons"}, {"density", "impulse_scan"}, of_grid);
    expect_refused({"--method", "harris"}, {"density", "impulse_scan"}, of_grid);
    expect_refused({"--profile", "step"}, {"density", "--profile"}, of_grid);
    expect_refused({"--sigmas", "2"}, {"density", "--sigmas"}, of_grid);
    expect_refused({"--grid", "smoke"}, {"--grid", ".vdb"});
    expect_refused({"--grid", ""}, {"--grid is empty"}, of_grid);
    expect_refused({"--particles", "23"}, {"--particles", "\"23\"", "24 clouds"},
                   {"cumulus_field", "a.png"});
    EXPECT_EQ(accepted({"--particles", "24"}, {"cumulus_field", "a.png"}).particles, 24u);
    expect_refused({"--camera", "1,2,3"}, {"--camera", "--look-at"});
}

// What the output or INPUT has no use for, in place of being passed over.
TEST(cloud_options, refuse_what_would_not_matter) {
    const cloud_option_context to_volume{"a.csv", "b.vdb"};
    const cloud_option_context to_places{"a.csv", "b.csv"};
    cloud_option_context sized = to_volume;
    sized.size = true;
    expect_refused({}, {"--size", "b.vdb", "no picture", ".png"}, sized);
    sized.out = "b.csv";
    expect_refused({"--probe", "p.csv"}, {"--size", "b.csv", ".png"}, sized);
    sized.out = "b.png";
    (void)accepted({}, sized);
    expect_refused({"--camera", "1,2,3", "--look-at", "4,5,6"}, {"--camera", ".png"}, to_volume);
    expect_refused({"--probe", "p.csv", "--camera", "1,2,3", "--look-at", "4,5,6"},
                   {"--camera", ".png"}, to_places);
    expect_refused({"--look-at", "4,5,6"}, {"--look-at", ".png"}, to_volume);
    for (const char* input : {"a.csv", "a.vdb"}) {
        expect_refused({}, {"--seed", "is a file", "cumulus"}, {input, "a.png", false, true});
    }
    (void)accepted({}, {"cumulus", "a.png", true, true});
    expect_refused({"--light", "octaves", "--octaves", "3"}, {"--octaves", ".vdb"}, to_volume);
    expect_refused({"--light", "octaves", "--phase", "isotropic"}, {"--phase", "octaves"},
                   to_volume);
    (void)accepted({"--light", "octaves", "--phase", "isotropic", "--octaves", "3"});
    (void)accepted({"--light", "octaves", "--octaves", "3", "--probe", "p.csv"}, to_places);
}

TEST(cloud_options, know_what_goes_in_and_out) {
    expect_refused({"--probe", "p.csv"}, {"--probe", "a.png", ".csv"});
    expect_refused({"--probe", "p.csv"}, {"--probe", "a.vdb", ".csv"}, {"a.csv", "a.vdb"});
    expect_refused({}, {"b.csv", "--probe POINTS.csv"}, {"a.csv", "b.csv"});
    expect_refused({"--probe", ""}, {"--probe is empty"}, {"a.csv", "b.csv"});
    EXPECT_EQ(accepted({"--probe", "p.csv"}, {"a.csv", "b.csv"}).output, cloud_output::probes);
    EXPECT_EQ(accepted({}, {"a.CSV", "b.VDB"}).output, cloud_output::volume);
    EXPECT_EQ(accepted({}, {"cumulus_field", "b.png"}).source, cloud_source::cumuli);
    for (const char* bad : {"a", "a.obj", "Cumulus", "cumulonimbus", "a.csv.gz"}) {
        expect_refused({}, {"INPUT", bad, "cumulus"}, {bad, "a.png"});
    }
    for (const char* bad : {"a", "a.jpg", "png"}) {
        expect_refused({}, {"-o", bad, ".png", ".vdb", ".csv"}, {"a.csv", bad});
    }
}

// Whatever is typed is an answer, and what is accepted lies in its range.
TEST(cloud_options, take_any_text) {
    std::mt19937 random(5);
    const words some{"",     "0",      "1",    "-1",       "64",     "nan",       "1,2",
                     "erf",  "harris", "list", "product",  "mie:10", "continuum", "hg:0.5",
                     "\xff", "a.csv",  "24",   "multiple", "1e999",  "120,50"};
    const words files{"a.csv", "a.vdb", "a.png", "cumulus", "b.csv", "\xff", ""};
    for (int i = 0; i < 20000; ++i) {
        cloud_option_words all;
        for (auto* word :
             {&all.sun, &all.volume, &all.method, &all.padding, &all.polygons, &all.route,
              &all.profile, &all.light, &all.octaves, &all.phase, &all.sigmas, &all.extinction,
              &all.albedo, &all.particles, &all.probe, &all.grid}) {
            if (random() % 6 == 0) {
                *word = some[random() % some.size()];
            }
        }
        all.half = random() % 4 == 0;
        const auto options =
            check(all, {files[random() % files.size()], files[random() % files.size()]});
        if (!options) {
            EXPECT_EQ(options.error().message.back(), '.');
            continue;
        }
        EXPECT_TRUE(options->volume >= 4 && options->volume <= 65536);
        EXPECT_TRUE(options->attenuation.sigmas > 0 && options->extinction >= 0);
        EXPECT_TRUE(options->albedo >= 0 && options->albedo <= 1);
        EXPECT_TRUE(options->octaves >= 1 && options->particles >= 1);
        EXPECT_EQ(options->probe.empty(), options->output != cloud_output::probes);
    }
}
