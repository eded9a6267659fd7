// Files are there whole or not at all.

#include "support.hpp"

#include <csignal>

using namespace skybark::tests;

namespace {

class tool_writing : public tool {
  protected:
    [[nodiscard]] words tree(const std::string& out) const {
        return {"tree", "quaking_aspen", "--sides", "3",  "--rings",
                "2",    "--size",        "64x40",   "-o", in_folder(out)};
    }
    /// Code 1, a sentence with these parts.
    static void expect_failed(const outcome& o, const words& parts) {
        EXPECT_EQ(o.code, 1) << o.err;
        EXPECT_TRUE(is_sentence(o.err));
        EXPECT_TRUE(has(o.err, parts));
        EXPECT_EQ(o.out, "");
    }
};

const std::vector<std::string> kinds{"a.png", "a.obj", "a.glb", "a.ply"};

} // namespace

TEST_F(tool_writing, leaves_its_file_and_nothing_else) {
    std::set<std::string> expected;
    for (const std::string& name : kinds) {
        const outcome o = skybark(tree(name));
        ASSERT_EQ(o.code, 0) << o.err;
        EXPECT_TRUE(has(o.out, {name, "segments", "triangles"}));
        EXPECT_EQ(o.err, "") << "no terminal, no bar";
        expected.insert(name);
        if (name == "a.obj") {
            expected.insert({"a.mtl", "a_bark.png", "a_bark_normal.png"});
        }
        EXPECT_EQ(names(), expected);
    }
    EXPECT_EQ(read_file(folder / "a.png").substr(0, 8), "\x89PNG\r\n\x1a\n");
    EXPECT_EQ(read_file(folder / "a.glb").substr(0, 4), "glTF");
    EXPECT_EQ(read_file(folder / "a.ply").substr(0, 4), "ply\n");
}

TEST_F(tool_writing, is_quiet_when_asked) {
    words arguments = tree("a.obj");
    arguments.push_back("--quiet");
    const outcome o = skybark(arguments);
    EXPECT_EQ(o.code, 0);
    EXPECT_EQ(o.out + o.err, "");
}

TEST_F(tool_writing, makes_the_same_file_each_time) {
    for (const std::string& name : kinds) {
        ASSERT_EQ(skybark(tree(name)).code, 0);
        const std::string first = read_file(folder / name);
        ASSERT_EQ(skybark(tree(name)).code, 0);
        EXPECT_TRUE(read_file(folder / name) == first) << name;
    }
}

TEST_F(tool_writing, names_a_folder_that_is_not_there) {
    for (const std::string& name : kinds) {
        expect_failed(skybark(tree("none/" + name)), {"none/" + name, "no folder"});
        EXPECT_EQ(names(), std::set<std::string>{});
    }
    words arguments = tree("a.obj");
    arguments.insert(arguments.end(), {"--stats", in_folder("none/stats.json")});
    expect_failed(skybark(arguments), {"none/stats.json"});
    EXPECT_EQ(names(), std::set<std::string>{});
}

TEST_F(tool_writing, does_not_replace_a_folder) {
    std::filesystem::create_directory(folder / "a.obj");
    expect_failed(skybark(tree("a.obj")), {"a.obj", "folder"});
    write_file(in_folder("file"), "");
    expect_failed(skybark(tree("file/a.obj")), {"file/a.obj"});
    EXPECT_EQ(names(), (std::set<std::string>{"a.obj", "file"}));
}

TEST_F(tool_writing, says_that_the_disk_is_full) {
    for (const std::string& name : kinds) {
        std::filesystem::create_symlink("/dev/full", folder / name);
        expect_failed(skybark(tree(name)), {name, "No space left on device"});
        EXPECT_TRUE(std::filesystem::is_symlink(folder / name));
    }
    words arguments = tree("b.obj");
    arguments.insert(arguments.end(), {"--stats", "/dev/full"});
    expect_failed(skybark(arguments), {"/dev/full", "No space left on device"});
    EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));
}

TEST_F(tool_writing, keeps_the_old_file_when_it_fails) {
    for (const std::string& name : kinds) {
        write_file(in_folder(name), "old");
        // An .obj's textures are as much in its way as itself.
        const std::string which = name == "a.obj" ? "a_bark.png" : name;
        expect_failed(skybark_after("ulimit -f 1", tree(name)), {which, "File too large"});
        EXPECT_EQ(read_file(folder / name), "old");
    }
    EXPECT_EQ(names(), std::set<std::string>(kinds.begin(), kinds.end()));
}

TEST_F(tool_writing, removes_its_file_when_it_is_stopped) {
    write_file(in_folder("a.obj"), "old");
    // Some 150 MB, so that there is time to stop it in the middle.
    const pid_t child = start({SKYBARK_TOOL, "tree", "quaking_aspen", "--sides", "32", "--rings",
                               "8", "-o", in_folder("a.obj")});
    int status = 0;
    while (names().size() < 2 && ::waitpid(child, &status, WNOHANG) == 0) {
        ::usleep(500);
    }
    ASSERT_EQ(names().size(), 2u) << "it ended before it could be stopped";
    ::kill(child, SIGTERM);
    EXPECT_EQ(finish(child).code, -SIGTERM);
    EXPECT_EQ(names(), std::set<std::string>{"a.obj"});
    EXPECT_EQ(read_file(folder / "a.obj"), "old");
}

TEST_F(tool_writing, follows_links_and_keeps_permissions) {
    write_file(in_folder("real.obj"), "old");
    std::filesystem::permissions(folder / "real.obj", std::filesystem::perms(0640));
    std::filesystem::create_symlink("real.obj", folder / "a.obj");
    ASSERT_EQ(skybark(tree("a.obj")).code, 0);
    EXPECT_TRUE(std::filesystem::is_symlink(folder / "a.obj"));
    EXPECT_EQ(read_file(folder / "real.obj").substr(0, 2), "# ");
    EXPECT_EQ(std::filesystem::status(folder / "real.obj").permissions(),
              std::filesystem::perms(0640));
    EXPECT_EQ(names(), (std::set<std::string>{"a.mtl", "a.obj", "a_bark.png", "a_bark_normal.png",
                                              "real.obj"}));
}

TEST_F(tool_writing, follows_no_link_in_circles) {
    std::filesystem::create_symlink("b.obj", folder / "a.obj");
    std::filesystem::create_symlink("a.obj", folder / "b.obj");
    expect_failed(skybark(tree("a.obj")), {"a.obj", "circle"});
}

TEST_F(tool_writing, can_write_to_standard_output) {
    const outcome o = skybark(
        {"tree", "quaking_aspen", "--quiet", "--stats", "/dev/stdout", "-o", in_folder("a.obj")});
    ASSERT_EQ(o.code, 0) << o.err;
    EXPECT_EQ(nlohmann::json::parse(o.out, nullptr, false)["command"], "tree");
}
