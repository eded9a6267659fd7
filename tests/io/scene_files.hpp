#pragma once
// A folder of files for the tests of scenes, and sentences about them.

#include <io/read_scene.hpp>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <vector>

namespace skybark::tests {

/// An empty folder for each test, gone afterwards.
class scene_files : public testing::Test {
  protected:
    void SetUp() override {
        std::string name =
            (std::filesystem::temp_directory_path() / "skybark_scenes.XXXXXX").string();
        ASSERT_NE(::mkdtemp(name.data()), nullptr);
        folder = name;
    }
    void TearDown() override {
        std::error_code ignored;
        std::filesystem::remove_all(folder, ignored);
    }

    [[nodiscard]] std::string in_folder(const std::string& name) const {
        return (folder / name).string();
    }
    void write(const std::string& name, std::string_view text) const {
        std::ofstream(folder / name, std::ios::binary) << text;
    }

    /// The scene in a file of the folder; its materials are empty where it can't be read.
    [[nodiscard]] io::triangle_scene read(const std::string& name) const {
        auto scene = io::read_scene(in_folder(name));
        EXPECT_TRUE(scene) << scene.error().message;
        return scene ? std::move(*scene) : io::triangle_scene();
    }

    /// Expects an error whose sentence has all of the parts.
    void expect_refused(const std::string& name, const std::vector<std::string>& parts) const {
        const auto scene = io::read_scene(in_folder(name));
        ASSERT_FALSE(scene) << name;
        EXPECT_EQ(scene.error().code, error_code::bad_input);
        const std::string& sentence = scene.error().message;
        EXPECT_EQ(sentence.back(), '.') << sentence;
        for (const std::string& part : parts) {
            EXPECT_NE(sentence.find(part), std::string::npos)
                << '"' << sentence << "\" lacks \"" << part << '"';
        }
    }

    std::filesystem::path folder;
};

} // namespace skybark::tests
