// Animated PNGs taken apart by the chunks of the specification; each frame is decoded by stb_image
// as a PNG of its own, and laid over the others as the specification says.

#include <io/write_apng.hpp>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <random>
#include <vector>

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#include <stb/stb_image.h>

using namespace skybark;

namespace {

using bytes = std::vector<std::uint8_t>;

struct chunk {
    std::string type;
    bytes data;
};

std::uint32_t number(const bytes& from, std::size_t at, std::size_t size = 4) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < size; ++i) {
        value = value << 8u | from.at(at + i);
    }
    return value;
}

/// Bit by bit, as PNG's annex D defines it.
std::uint32_t crc_of(const bytes& data, std::size_t first, std::size_t end) {
    std::uint32_t c = 0xffffffffu;
    for (std::size_t i = first; i < end; ++i) {
        c ^= data[i];
        for (int k = 0; k < 8; ++k) {
            c = (c >> 1u) ^ ((c & 1u) != 0 ? 0xedb88320u : 0u);
        }
    }
    return c ^ 0xffffffffu;
}

std::vector<chunk> chunks_of(const bytes& file) {
    const bytes signature{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    EXPECT_TRUE(file.size() > 8 && std::equal(signature.begin(), signature.end(), file.begin()));
    std::vector<chunk> all;
    for (std::size_t at = 8; at < file.size();) {
        const std::size_t size = number(file, at);
        if (at + 12 + size > file.size()) {
            ADD_FAILURE() << "the file ends inside a chunk";
            return all;
        }
        const auto begin = file.begin() + static_cast<std::ptrdiff_t>(at);
        all.push_back({std::string(begin + 4, begin + 8),
                       bytes(begin + 8, begin + 8 + static_cast<std::ptrdiff_t>(size))});
        EXPECT_EQ(number(file, at + 8 + size), crc_of(file, at + 4, at + 8 + size));
        at += 12 + size;
    }
    return all;
}

void append_chunk(bytes& to, const std::string& type, const bytes& data) {
    const auto size = static_cast<std::uint32_t>(data.size());
    for (const unsigned shift : {24u, 16u, 8u, 0u}) {
        to.push_back(static_cast<std::uint8_t>(size >> shift));
    }
    to.insert(to.end(), type.begin(), type.end());
    to.insert(to.end(), data.begin(), data.end());
    to.insert(to.end(), 4, 0); // stb_image looks at no checksum
}

/// The pixels of one frame's rectangle.
bytes decoded(const bytes& header, const bytes& control, const bytes& data) {
    bytes png{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    bytes own = header;
    std::copy_n(control.begin() + 4, 8, own.begin());
    append_chunk(png, "IHDR", own);
    append_chunk(png, "IDAT", data);
    append_chunk(png, "IEND", {});
    int width = 0;
    int height = 0;
    int channels = 0;
    stbi_uc* pixels = stbi_load_from_memory(png.data(), static_cast<int>(png.size()), &width,
                                            &height, &channels, 4);
    if (pixels == nullptr) {
        ADD_FAILURE() << stbi_failure_reason();
        return {};
    }
    EXPECT_EQ(static_cast<std::uint32_t>(width), number(control, 4));
    EXPECT_EQ(static_cast<std::uint32_t>(height), number(control, 8));
    bytes all(pixels, pixels + std::size_t{4} * number(control, 4) * number(control, 8));
    stbi_image_free(pixels);
    return all;
}

struct animation {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::vector<bytes> frames; ///< what a viewer shows
    std::vector<bytes> controls;
    std::size_t size = 0; ///< of the file
};

/// "Over", by the formula of PNG's section 13.16 for the cases that need no rounding.
void lay_over(bytes& canvas, std::size_t at, const std::uint8_t* pixel, bool over) {
    if (over && pixel[3] == 0) {
        return;
    }
    EXPECT_TRUE(!over || pixel[3] == 255) << "a mixture would round";
    std::copy_n(pixel, 4, canvas.begin() + static_cast<std::ptrdiff_t>(at));
}

animation read_apng(const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    const bytes file{std::istreambuf_iterator<char>(stream), {}};
    const std::vector<chunk> chunks = chunks_of(file);
    animation result;
    result.size = file.size();
    if (chunks.size() < 5 || chunks[0].type != "IHDR" || chunks[1].type != "acTL" ||
        chunks.back().type != "IEND") {
        ADD_FAILURE() << "chunks are missing";
        return result;
    }
    result.width = number(chunks[0].data, 0);
    result.height = number(chunks[0].data, 4);
    EXPECT_EQ(number(chunks[1].data, 4), 0u) << "without end";
    bytes canvas(std::size_t{4} * result.width * result.height);
    std::uint32_t sequence = 0;
    for (std::size_t i = 2; i + 1 < chunks.size(); i += 2) {
        const bytes& control = chunks[i].data;
        EXPECT_EQ(chunks[i].type, "fcTL");
        EXPECT_EQ(control.size(), 26u);
        EXPECT_EQ(number(control, 0), sequence++);
        bytes data = chunks[i + 1].data;
        if (i == 2) {
            EXPECT_EQ(chunks[i + 1].type, "IDAT");
        } else {
            EXPECT_EQ(chunks[i + 1].type, "fdAT");
            EXPECT_EQ(number(data, 0), sequence++);
            data.erase(data.begin(), data.begin() + 4);
        }
        const std::uint32_t width = number(control, 4);
        const std::uint32_t height = number(control, 8);
        const std::uint32_t x0 = number(control, 12);
        const std::uint32_t y0 = number(control, 16);
        EXPECT_LE(x0 + width, result.width);
        EXPECT_LE(y0 + height, result.height);
        EXPECT_EQ(control.at(24), 0) << "disposal";
        const bytes pixels = decoded(chunks[0].data, control, data);
        for (std::size_t p = 0; p < pixels.size() / 4; ++p) {
            const std::size_t at = 4 * ((y0 + p / width) * result.width + x0 + p % width);
            lay_over(canvas, at, pixels.data() + 4 * p, control.at(25) == 1);
        }
        result.frames.push_back(canvas);
        result.controls.push_back(control);
    }
    EXPECT_EQ(number(chunks[1].data, 0), result.frames.size());
    return result;
}

class write_apng : public testing::Test {
  protected:
    void SetUp() override {
        // One for each test: they may run at the same time.
        folder = std::filesystem::temp_directory_path() /
                 std::string("skybark_write_apng_")
                     .append(testing::UnitTest::GetInstance()->current_test_info()->name());
        std::filesystem::remove_all(folder);
        std::filesystem::create_directory(folder);
    }
    void TearDown() override { std::filesystem::remove_all(folder); }
    [[nodiscard]] std::string path() const { return (folder / "a.apng").string(); }

    animation round_trip(const std::vector<bytes>& frames, std::uint32_t width,
                         std::uint32_t height, io::apng_delay delay = {1, 24}) {
        auto writer = io::apng_writer::create(path(), width, height,
                                              static_cast<std::uint32_t>(frames.size()), delay);
        EXPECT_TRUE(writer);
        for (const bytes& frame : frames) {
            const auto added = writer->add(frame);
            EXPECT_TRUE(added) << added.error().message;
        }
        const auto done = writer->commit();
        EXPECT_TRUE(done) << done.error().message;
        return read_apng(path());
    }

    std::filesystem::path folder;
};

constexpr std::uint32_t wide = 61;
constexpr std::uint32_t high = 37;

bytes gradient(std::uint8_t alpha) {
    bytes pixels;
    for (std::uint32_t i = 0; i < wide * high; ++i) {
        for (const std::uint32_t value : {i, 5 * (i % wide), 3 * (i / wide)}) {
            pixels.push_back(static_cast<std::uint8_t>(value));
        }
        pixels.push_back(alpha);
    }
    return pixels;
}

void paint(bytes& pixels, std::uint32_t x0, std::uint32_t y0, std::uint32_t size,
           const bytes& color) {
    for (std::uint32_t y = y0; y < y0 + size; ++y) {
        for (std::uint32_t x = x0; x < x0 + size; ++x) {
            std::copy(color.begin(), color.end(), pixels.begin() + 4 * (y * wide + x));
        }
    }
}

} // namespace

TEST_F(write_apng, is_read_back_as_it_was) {
    std::vector<bytes> frames;
    for (std::uint32_t i = 0; i < 8; ++i) {
        frames.push_back(gradient(255));
        paint(frames.back(), 3 * i, 2 * i, 6, {255, static_cast<std::uint8_t>(i), 0, 255});
        // Far from each other, so that most of the rectangle is as it was.
        paint(frames.back(), 50, 30, 2, {static_cast<std::uint8_t>(i), 0, 0, 255});
    }
    frames.push_back(frames.back()); // nothing changes
    frames.push_back(gradient(120)); // everything, not opaque
    frames.push_back(frames.back());
    paint(frames.back(), 10, 10, 5, {1, 2, 3, 0}); // to nothing
    frames.push_back(gradient(255));
    std::mt19937 random(3);
    for (int i = 0; i < 3; ++i) {
        frames.emplace_back(frames.back().size());
        std::generate(frames.back().begin(), frames.back().end(),
                      [&] { return static_cast<std::uint8_t>(random()); });
    }
    // Two corners of noise: to lay them over would be small, but they aren't opaque.
    frames.push_back(frames.back());
    paint(frames.back(), 0, 0, 2, {9, 9, 9, 100});
    paint(frames.back(), 58, 34, 2, {9, 9, 9, 255});
    const animation read = round_trip(frames, wide, high, {3, 50});
    EXPECT_EQ(read.width, wide);
    EXPECT_EQ(read.height, high);
    ASSERT_EQ(read.frames.size(), frames.size());
    for (std::size_t i = 0; i < frames.size(); ++i) {
        EXPECT_EQ(read.frames[i], frames[i]) << "frame " << i;
        EXPECT_EQ(number(read.controls[i], 20, 2), 3u);
        EXPECT_EQ(number(read.controls[i], 22, 2), 50u);
    }
    EXPECT_EQ(number(read.controls[8], 4), 1u) << "nothing changes";
}

TEST_F(write_apng, takes_any_size) {
    for (const auto& [width, height] : {std::pair{1u, 1u}, {1u, 9u}, {300u, 1u}, {16384u, 2u}}) {
        std::vector<bytes> frames(2, bytes(std::size_t{4} * width * height, 77));
        frames[1].back() = 255;
        EXPECT_EQ(round_trip(frames, width, height).frames, frames) << width << " x " << height;
    }
}

TEST_F(write_apng, is_a_picture_for_those_who_know_no_animation) {
    round_trip({gradient(255), gradient(9)}, wide, high);
    int width = 0;
    int height = 0;
    int channels = 0;
    stbi_uc* pixels = stbi_load(path().c_str(), &width, &height, &channels, 0);
    ASSERT_NE(pixels, nullptr);
    EXPECT_EQ(channels, 4);
    EXPECT_EQ(bytes(pixels, pixels + std::size_t{4} * wide * high), gradient(255));
    stbi_image_free(pixels);
}

TEST_F(write_apng, stores_what_changes_alone) {
    bytes noise(gradient(255).size());
    std::mt19937 random(4);
    std::generate(noise.begin(), noise.end(), [&] { return static_cast<std::uint8_t>(random()); });
    std::vector<bytes> frames(20, noise); // a rectangle of it has some 9 kB
    for (std::uint32_t i = 0; i < 20; ++i) {
        // What is uncovered again has to be opaque to be laid over.
        paint(frames[i], 0, 0, 25, {0, 0, 0, 255});
        paint(frames[i], 34, 12, 25, {0, 0, 0, 255});
        paint(frames[i], i, 1, 2, {255, 255, 255, 255});
        paint(frames[i], 57 - i, 33, 2, {255, 255, 255, 255});
    }
    const std::size_t first = round_trip({frames[0]}, wide, high).size;
    // A frame more takes 38 bytes of frame control, 16 of frame data and what is new.
    EXPECT_LT(round_trip(frames, wide, high).size, first + 19 * 300);
}

TEST_F(write_apng, says_how_long_a_frame_is_shown) {
    const auto expect = [](double rate, unsigned numerator, unsigned denominator) {
        const io::apng_delay delay = io::delay_of(rate);
        EXPECT_EQ(delay.numerator, numerator) << rate;
        EXPECT_EQ(delay.denominator, denominator) << rate;
    };
    expect(24, 1, 24);
    expect(12.5, 2, 25);
    expect(23.976, 125, 2997);
    expect(0.1, 10, 1);
    expect(65535, 1, 65535);
    expect(1e9, 1, 65535);
    expect(1e-9, 65535, 1);
    expect(0, 65535, 1);
    expect(std::nan(""), 65535, 1);
    // Any rate in between, within what two numbers of 16 bits can say at worst.
    for (double rate = 1e-4; rate < 6e4; rate *= 1.37) {
        const io::apng_delay delay = io::delay_of(rate);
        EXPECT_NEAR(double(delay.denominator) / delay.numerator / rate, 1,
                    1e-5 + 0.5 / 65535 * std::max(rate, 1 / rate))
            << rate;
    }
}

TEST_F(write_apng, refuses_what_does_not_fit) {
    for (const auto& [width, height, frames] : {std::tuple{0u, 4u, 1u},
                                                {4u, 0u, 1u},
                                                {16385u, 1u, 1u},
                                                {1u, 65536u, 1u},
                                                {4u, 4u, 0u},
                                                {4u, 4u, 0x40000001u}}) {
        const auto writer = io::apng_writer::create(path(), width, height, frames, {});
        ASSERT_FALSE(writer);
        EXPECT_NE(writer.error().message.find(path()), std::string::npos);
        EXPECT_EQ(writer.error().message.back(), '.');
    }
    EXPECT_FALSE(io::apng_writer::create("/nowhere/a.apng", 4, 4, 1, {}));
    {
        auto writer = io::apng_writer::create(path(), wide, high, 2, {});
        ASSERT_TRUE(writer);
        EXPECT_FALSE(writer->add(bytes(16)));
        EXPECT_TRUE(writer->add(gradient(255)));
        EXPECT_FALSE(writer->commit()) << "one is missing";
        EXPECT_TRUE(writer->add(gradient(255)));
        EXPECT_FALSE(writer->add(gradient(255))) << "one too many";
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder)) << "nothing is left of what isn't whole";
}
