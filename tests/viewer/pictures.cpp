// Where a picture goes in a window, and under which name into a folder.

#include <viewer/picture_file.hpp>

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <io/read_image.hpp>
#include <unistd.h>

namespace skybark::viewer {
namespace {

void expect_placed(glm::uvec2 picture, glm::uvec2 window, glm::uvec2 low, glm::uvec2 high) {
    const placed at = place(picture, window);
    EXPECT_EQ(at.low, low) << picture.x << " x " << picture.y;
    EXPECT_EQ(at.high, high) << picture.x << " x " << picture.y;
}

TEST(viewer_pictures, keep_their_shape_in_the_middle_of_any_window) {
    expect_placed({320, 200}, {320, 200}, {0, 0}, {320, 200});
    expect_placed({320, 200}, {640, 400}, {0, 0}, {640, 400});
    expect_placed({320, 200}, {420, 200}, {50, 0}, {370, 200});
    expect_placed({320, 200}, {320, 300}, {0, 50}, {320, 250});
    expect_placed({200, 100}, {100, 200}, {0, 75}, {100, 125});
    expect_placed({16384, 1}, {3, 100}, {0, 49}, {3, 50}); // never less than a pixel
    expect_placed({1, 16384}, {100, 3}, {49, 0}, {50, 3});
}

class viewer_folder : public testing::Test {
  protected:
    void SetUp() override {
        std::string name = (std::filesystem::temp_directory_path() / "skybark.XXXXXX").string();
        ASSERT_NE(::mkdtemp(name.data()), nullptr);
        folder = name;
    }
    void TearDown() override { std::filesystem::remove_all(folder); }

    std::string next() const {
        const auto name = next_free_name(folder.string());
        EXPECT_TRUE(name);
        return name ? std::filesystem::path(*name).filename().string() : "";
    }

    std::filesystem::path folder;
};

TEST_F(viewer_folder, gives_each_picture_a_name_of_its_own) {
    EXPECT_EQ(next(), "skybark_0001.png");
    std::ofstream(folder / "skybark_0001.png") << "mine";
    std::filesystem::create_symlink("nowhere", folder / "skybark_0002.png"); // that is one, too
    std::filesystem::create_directory(folder / "skybark_0003.png");
    EXPECT_EQ(next(), "skybark_0004.png");
}

TEST_F(viewer_folder, gets_pictures_without_holes) {
    const std::string path = (folder / "a.png").string();
    ASSERT_TRUE(save(path, {{10, 20, 30, 0, 40, 50, 60, 128}, 2, 1}));
    const auto back = io::read_colours(path);
    ASSERT_TRUE(back);
    EXPECT_EQ(back->rgba, (std::vector<std::uint8_t>{10, 20, 30, 255, 40, 50, 60, 255}));
}

TEST_F(viewer_folder, that_is_not_there_is_named) {
    const auto done = save((folder / "none" / "a.png").string(), {{0, 0, 0, 0}, 1, 1});
    ASSERT_FALSE(done);
    EXPECT_NE(done.error().message.find("none"), std::string::npos);
}

} // namespace
} // namespace skybark::viewer
