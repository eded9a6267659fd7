// What --stats, devices and conformance tell to other programs.

#include "support.hpp"

using namespace skybark::tests;
using nlohmann::json;

namespace {

class tool_reports : public tool {
  protected:
    /// Stats of three segments: a trunk, one that continues it, and a side branch.
    json stats(const words& more) {
        write_file(in_folder("t.csv"), "ID,parentID,startX,startY,startZ,endX,endY,endZ,radius\n"
                                       "1,-1,0,0,0,0,0,1,0.1\n"
                                       "2,1,0,0,1,0,0.1,2,0.08\n"
                                       "3,1,0,0,1,1,0,1.2,0.02\n");
        words arguments{"tree", in_folder("t.csv"), "--stats", in_folder("s.json")};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const outcome o = skybark(arguments);
        EXPECT_EQ(o.code, 0) << o.err;
        return json::parse(read_file(folder / "s.json"), nullptr, false);
    }
};

/// Of `sides` and `rings`: tubes, and the caps at both ends of two chains.
struct expected_counts {
    std::uint64_t vertices = 0;
    std::uint64_t triangles = 0;
};
expected_counts counts_of(std::uint64_t segments, std::uint64_t chains, std::uint64_t sides,
                          std::uint64_t rings) {
    return {segments * rings * (sides + 1) + 2 * chains * sides,
            segments * (rings - 1) * sides * 2 + 2 * chains * (sides - 2)};
}

} // namespace

TEST_F(tool_reports, counts) {
    const json s = stats({"-o", in_folder("a.obj"), "--tubes"});
    const auto expected = counts_of(3, 2, 8, 4);
    EXPECT_EQ(s["command"], "tree");
    EXPECT_EQ(s["backend"], "cpu");
    EXPECT_TRUE(s["driver"].is_string() && !s["driver"].get<std::string>().empty());
    EXPECT_TRUE(s["device"].is_string() && !s["device"].get<std::string>().empty());
    EXPECT_EQ(s["counts"]["segments"], 3);
    EXPECT_EQ(s["counts"]["chains"], 2);
    EXPECT_EQ(s["counts"]["vertices"], expected.vertices);
    EXPECT_EQ(s["counts"]["triangles"], expected.triangles);
    EXPECT_EQ(s["counts"]["indices"], 3 * expected.triangles);
    EXPECT_EQ(s["counts"]["parts"], 2) << "tubes and caps";
    EXPECT_EQ(s["counts"]["leaves"], 0) << "a scan has none unless it is told";
    EXPECT_EQ(s["counts"]["frames"], 1);
}

// One closed surface of genus 0: F = 2V − 4, and the places of V are those of the tubes' rings, of
// tips and of the collar.
TEST_F(tool_reports, counts_of_a_closed_surface) {
    const json s = stats({"-o", in_folder("a.obj")});
    EXPECT_EQ(s["counts"]["parts"], 1);
    EXPECT_EQ(s["counts"]["indices"], 3 * s["counts"]["triangles"].get<std::uint64_t>());
    const std::string file = read_file(folder / "a.obj");
    std::uint64_t places = 0;
    for (std::size_t at = file.find("\nv "); at != std::string::npos;
         at = file.find("\nv ", at + 1)) {
        ++places;
    }
    EXPECT_EQ(s["counts"]["triangles"], 2 * places - 4);
}

TEST_F(tool_reports, counts_leaves_and_frames) {
    const json s = stats({"-o", in_folder("a_%d.obj"), "--leaves", "--frames", "2"});
    const auto leaves = s["counts"]["leaves"].get<std::uint64_t>();
    EXPECT_EQ(leaves, 2 * 12u) << "two twigs of a dozen each";
    EXPECT_EQ(s["counts"]["frames"], 2);
    const json bare = stats({"-o", in_folder("a.obj"), "--no-leaves"});
    // Two halves of five corners each: three triangles a half.
    EXPECT_EQ(s["counts"]["triangles"],
              bare["counts"]["triangles"].get<std::uint64_t>() + 6 * leaves);
}

TEST_F(tool_reports, counts_by_options) {
    const auto expected = counts_of(3, 2, 5, 7);
    const json rings = stats({"-o", in_folder("a.obj"), "--sides", "5", "--rings", "7", "--tubes"});
    EXPECT_EQ(rings["counts"]["vertices"], expected.vertices);
    EXPECT_EQ(rings["counts"]["triangles"], expected.triangles);
    const json list =
        stats({"-o", in_folder("a.obj"), "--sides", "5", "--rings", "7", "--form", "list"});
    EXPECT_EQ(list["counts"]["triangles"], expected.triangles);
    EXPECT_EQ(list["counts"]["vertices"], 3 * expected.triangles);
    const json padded = stats({"-o", in_folder("a.obj"), "--sides", "5", "--rings", "7", "--form",
                               "list", "--padding", "degenerate"});
    EXPECT_EQ(padded["counts"]["triangles"], 3 * 2 * 5 * (7 + 1));
    const json skeleton = stats({"-o", in_folder("a.obj"), "--skeleton"});
    EXPECT_EQ(skeleton["counts"]["chains"], 2) << "of the tree; each segment is a stick";
    EXPECT_EQ(skeleton["counts"]["triangles"], counts_of(3, 3, 4, 2).triangles);
}

TEST_F(tool_reports, seconds_and_bytes) {
    const json s = stats({"-o", in_folder("a.png"), "--size", "32x20"});
    double sum = 0;
    for (const char* stage : {"read", "build", "mesh", "draw", "write"}) {
        ASSERT_TRUE(s["seconds"][stage].is_number()) << stage;
        EXPECT_GT(s["seconds"][stage].get<double>(), 0) << stage;
        sum += s["seconds"][stage].get<double>();
    }
    EXPECT_NEAR(s["seconds"]["total"].get<double>(), sum, 1e-6);
    EXPECT_LT(sum, 600);
    EXPECT_GE(s["bytes"]["up"].get<std::uint64_t>(), 3 * 16 + 5 * 48u);
    EXPECT_GE(s["bytes"]["down"].get<std::uint64_t>(), 32 * 20 * 4u);
}

TEST_F(tool_reports, devices) {
    const outcome text = skybark({"devices"});
    EXPECT_EQ(text.code, 0);
    EXPECT_TRUE(has(text.out, {"cpu", "opengl", "vulkan"}));
    const outcome o = skybark({"devices", "--json"});
    ASSERT_EQ(o.code, 0) << o.err;
    const json all = json::parse(o.out, nullptr, false);
    ASSERT_TRUE(all["backends"].is_array());
    ASSERT_EQ(all["backends"].size(), 3u);
    for (const json& backend : all["backends"]) {
        const bool available = backend["available"].get<bool>();
        EXPECT_EQ(available, !backend["devices"].empty());
        EXPECT_EQ(available, !backend.contains("reason"));
        EXPECT_TRUE(available || !is_required(backend["name"].get<std::string>()));
        for (const json& device : backend["devices"]) {
            EXPECT_TRUE(device["index"].is_number_unsigned());
            for (const char* key : {"name", "driver", "api"}) {
                EXPECT_TRUE(device[key].is_string() && !device[key].get<std::string>().empty());
            }
            EXPECT_GE(device["limits"]["max_buffer_bytes"].get<std::uint64_t>(), 1u << 20u);
            EXPECT_GE(device["limits"]["max_image_size"].get<std::uint64_t>(), 4096u);
        }
    }
}

TEST_F(tool_reports, devices_says_why_a_backend_is_not_there) {
    const outcome o = run({"env", "VK_ICD_FILENAMES=/nowhere.json", "VK_DRIVER_FILES=/nowhere.json",
                           SKYBARK_TOOL, "devices", "--json"});
    ASSERT_EQ(o.code, 0) << o.err;
    const json vulkan = json::parse(o.out, nullptr, false)["backends"][2];
    EXPECT_EQ(vulkan["available"], false);
    EXPECT_GT(vulkan["reason"].get<std::string>().size(), 20u);
    const outcome tree =
        run({"env", "VK_ICD_FILENAMES=/nowhere.json", "VK_DRIVER_FILES=/nowhere.json", SKYBARK_TOOL,
             "tree", "quaking_aspen", "--backend", "vulkan", "-o", in_folder("a.obj")});
    EXPECT_EQ(tree.code, 3);
    EXPECT_TRUE(is_sentence(tree.err));
    EXPECT_EQ(names(), std::set<std::string>{});
}

TEST_F(tool_reports, conformance) {
    for (const std::string backend : {"cpu", "opengl", "vulkan"}) {
        const outcome o = skybark({"conformance", "--backend", backend, "--filter", "map.range_*1",
                                   "--json", in_folder("c.json")});
        if (o.code == 3 && !is_required(backend)) {
            continue;
        }
        ASSERT_EQ(o.code, 0) << backend << ": " << o.out << o.err;
        const json report = json::parse(read_file(folder / "c.json"), nullptr, false);
        EXPECT_GT(report["passed"], 0);
        EXPECT_EQ(report["failed"], 0);
        EXPECT_EQ(report["skipped"], 0);
        ASSERT_EQ(report["cases"].size(), report["passed"].get<std::size_t>());
        for (const json& one : report["cases"]) {
            EXPECT_EQ(one["name"].get<std::string>().rfind(backend + "/map.range_", 0), 0u);
            EXPECT_EQ(one["status"], "passed");
        }
    }
}

TEST_F(tool_reports, conformance_wants_a_case) {
    const outcome o = skybark(
        {"conformance", "--quiet", "--filter", "no.such_case", "--json", in_folder("c.json")});
    EXPECT_EQ(o.code, 2);
    EXPECT_TRUE(has(o.err, {"no.such_case"}));
    EXPECT_EQ(names(), std::set<std::string>{});
}
