#include <io/atomic_file.hpp>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>

using namespace skybark;
namespace fs = std::filesystem;

namespace {

class atomic_file : public testing::Test {
  protected:
    void SetUp() override {
        std::string name = (fs::temp_directory_path() / "skybark_atomic.XXXXXX").string();
        ASSERT_NE(::mkdtemp(name.data()), nullptr);
        folder = name;
        path = (folder / "file").string();
    }
    void TearDown() override { fs::remove_all(folder); }

    [[nodiscard]] std::size_t files() const {
        return static_cast<std::size_t>(
            std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
    }
    [[nodiscard]] std::string content() const {
        std::ifstream file(path, std::ios::binary);
        return {std::istreambuf_iterator<char>(file), {}};
    }
    void put(const std::string& text) const { std::ofstream(path) << text; }

    fs::path folder;
    std::string path;
};

} // namespace

TEST_F(atomic_file, appears_when_committed) {
    auto file = io::atomic_file::create(path);
    ASSERT_TRUE(file) << file.error().message;
    ASSERT_TRUE(file->write("one "));
    ASSERT_TRUE(file->write("two"));
    EXPECT_FALSE(fs::exists(path));
    ASSERT_TRUE(file->commit());
    EXPECT_EQ(content(), "one two");
    EXPECT_EQ(files(), 1u);
}

// A rename that fails would come after all of the work.
TEST_F(atomic_file, knows_names_that_are_too_long) {
    const std::string longest = (folder / std::string(255, 'n')).string();
    EXPECT_TRUE(io::check_writable(longest));
    ASSERT_TRUE(io::write_file(longest, "all"));
    for (const auto& refused :
         {io::check_writable(longest + "n"), io::write_file(longest + "n", "")}) {
        ASSERT_FALSE(refused);
        EXPECT_NE(refused.error().message.find("its name has 256 bytes; expected at most 255."),
                  std::string::npos)
            << refused.error().message;
    }
    EXPECT_EQ(files(), 1u);
}

TEST_F(atomic_file, leaves_the_old_file_when_abandoned) {
    put("old");
    {
        auto file = io::atomic_file::create(path);
        ASSERT_TRUE(file);
        ASSERT_TRUE(file->write("new"));
        EXPECT_EQ(files(), 2u);
        EXPECT_EQ(content(), "old");
    }
    EXPECT_EQ(content(), "old");
    EXPECT_EQ(files(), 1u);
}

TEST_F(atomic_file, moves_without_losing_its_file) {
    auto made = io::atomic_file::create(path);
    ASSERT_TRUE(made);
    io::atomic_file file = std::move(*made);
    io::atomic_file last = std::move(file);
    ASSERT_TRUE(last.write("moved"));
    ASSERT_TRUE(last.commit());
    EXPECT_EQ(content(), "moved");
    EXPECT_EQ(files(), 1u);
}

TEST_F(atomic_file, has_a_name_of_its_own_each_time) {
    auto a = io::atomic_file::create(path);
    auto b = io::atomic_file::create(path);
    ASSERT_TRUE(a && b);
    ASSERT_TRUE(a->write("a") && b->write("b"));
    ASSERT_TRUE(a->commit());
    EXPECT_EQ(content(), "a");
    ASSERT_TRUE(b->commit());
    EXPECT_EQ(content(), "b");
    EXPECT_EQ(files(), 1u);
}

TEST_F(atomic_file, is_removed_by_a_signal_handler) {
    {
        auto file = io::atomic_file::create(path);
        ASSERT_TRUE(file);
        ASSERT_EQ(files(), 1u);
        io::remove_unfinished();
        EXPECT_EQ(files(), 0u);
    }
    ASSERT_TRUE(io::write_file(path, "kept"));
    io::remove_unfinished();
    EXPECT_EQ(content(), "kept") << "a finished file is none of its business";
}

TEST_F(atomic_file, several_wait_for_their_names) {
    auto a = io::atomic_file::create(path);
    auto b = io::atomic_file::create(path + ".b");
    ASSERT_TRUE(a && b);
    ASSERT_TRUE(a->write("a") && b->write("b"));
    ASSERT_TRUE(a->finish() && b->finish());
    EXPECT_FALSE(std::filesystem::exists(path));
    ASSERT_TRUE(b->commit());
    EXPECT_EQ(files(), 2u);
    io::remove_unfinished();
    EXPECT_EQ(files(), 1u) << "the one without a name";
    EXPECT_TRUE(std::filesystem::exists(path + ".b"));
}

TEST_F(atomic_file, takes_names_as_long_as_the_file_system_does) {
    path = (folder / std::string(255, 'n')).string();
    const auto done = io::write_file(path, "long");
    ASSERT_TRUE(done) << done.error().message;
    EXPECT_EQ(content(), "long");
    EXPECT_FALSE(io::write_file((folder / std::string(256, 'n')).string(), "too long"));
    EXPECT_EQ(files(), 1u);
}

TEST_F(atomic_file, says_what_cannot_be_written) {
    const std::string nowhere = (folder / "none" / "file").string();
    for (const std::string& bad :
         {std::string(), nowhere, folder.string(), folder.string() + "/"}) {
        EXPECT_FALSE(io::check_writable(bad)) << bad;
        const auto done = io::write_file(bad, "text");
        ASSERT_FALSE(done) << bad;
        EXPECT_GT(done.error().message.size(), 20u);
        EXPECT_EQ(done.error().message.back(), '.');
    }
    EXPECT_EQ(files(), 0u);
    EXPECT_TRUE(io::check_writable(path));
    EXPECT_EQ(files(), 0u) << "asking leaves nothing";
}

TEST_F(atomic_file, tells_of_a_full_disk) {
    const auto done = io::write_file("/dev/full", "text");
    ASSERT_FALSE(done);
    EXPECT_NE(done.error().message.find("No space left on device"), std::string::npos);
    EXPECT_TRUE(fs::is_character_file("/dev/full"));
}
