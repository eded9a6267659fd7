#include <io/write_apng.hpp>

#include <io/text_input.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <limits>
#include <memory>

// Static: a library that we load may bring the same functions.
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#include <stb/stb_image_write.h>

namespace skybark::io {

namespace {

using bytes = std::vector<std::uint8_t>;

constexpr std::size_t channels = 4;

void add_number(bytes& to, std::uint32_t value, unsigned size) {
    for (unsigned shift = 8 * size; shift > 0; shift -= 8) {
        to.push_back(static_cast<std::uint8_t>(value >> (shift - 8)));
    }
}

/// The table of CRC-32, by the polynomial 0xedb88320 (PNG, annex D).
constexpr std::array<std::uint32_t, 256> crc_table = [] {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t i = 0; i < 256; ++i) {
        std::uint32_t c = i;
        for (int k = 0; k < 8; ++k) {
            c = (c & 1u) != 0 ? 0xedb88320u ^ (c >> 1u) : c >> 1u;
        }
        table[i] = c;
    }
    return table;
}();

std::uint32_t crc_of(std::span<const std::uint8_t> data) {
    std::uint32_t c = 0xffffffffu;
    for (const std::uint8_t byte : data) {
        c = crc_table[(c ^ byte) & 0xffu] ^ (c >> 8u);
    }
    return ~c;
}

/// Length, type, data, checksum of the latter two.
result<void> write_chunk(atomic_file& file, const char (&type)[5],
                         std::span<const std::uint8_t> data) {
    bytes chunk;
    chunk.reserve(data.size() + 12);
    add_number(chunk, static_cast<std::uint32_t>(data.size()), 4);
    chunk.insert(chunk.end(), type, type + 4);
    chunk.insert(chunk.end(), data.begin(), data.end());
    add_number(chunk, crc_of(std::span<const std::uint8_t>(chunk).subspan(4)), 4);
    return file.write(std::as_bytes(std::span<const std::uint8_t>(chunk)));
}

/// Part of a picture, from its upper left corner.
struct rectangle {
    std::uint32_t x = 0;
    std::uint32_t y = 0;
    std::uint32_t width = 1;
    std::uint32_t height = 1;
};

/// The pixels of a rectangle, row after row.
bytes cut(std::span<const std::uint8_t> pixels, std::uint32_t width, const rectangle& from) {
    bytes part;
    part.reserve(channels * from.width * from.height);
    for (std::uint32_t y = from.y; y < from.y + from.height; ++y) {
        const auto row =
            pixels.subspan(channels * (std::size_t{y} * width + from.x), channels * from.width);
        part.insert(part.end(), row.begin(), row.end());
    }
    return part;
}

/// What has changed; a single pixel where nothing has, since a frame can't be empty.
rectangle changed_part(std::span<const std::uint8_t> before, std::span<const std::uint8_t> now,
                       std::uint32_t width, std::uint32_t height) {
    std::uint32_t left = width;
    std::uint32_t right = 0;
    std::uint32_t top = height;
    std::uint32_t bottom = 0;
    for (std::uint32_t y = 0; y < height; ++y) {
        const std::size_t row = channels * std::size_t{y} * width;
        for (std::uint32_t x = 0; x < width; ++x) {
            const std::size_t at = row + channels * x;
            if (std::memcmp(before.data() + at, now.data() + at, channels) != 0) {
                left = std::min(left, x);
                right = std::max(right, x);
                top = std::min(top, y);
                bottom = y;
            }
        }
    }
    return left == width ? rectangle{} : rectangle{left, top, right - left + 1, bottom - top + 1};
}

/// Makes transparent what is as it was. Returns false where that isn't possible: what is laid over
/// must be opaque to replace what is under it.
bool leave_out_same(const bytes& before, bytes& now) {
    for (std::size_t i = 0; i < now.size(); i += channels) {
        if (std::memcmp(before.data() + i, now.data() + i, channels) == 0) {
            std::memset(now.data() + i, 0, channels);
        } else if (now[i + 3] != 255) {
            return false;
        }
    }
    return true;
}

std::uint8_t paeth(int left, int above, int corner) {
    const int p = left + above - corner;
    const int a = std::abs(p - left);
    const int b = std::abs(p - above);
    const int c = std::abs(p - corner);
    return static_cast<std::uint8_t>(a <= b && a <= c ? left : b <= c ? above : corner);
}

/// A row minus what PNG's filter foretells of it.
void filter_row(unsigned filter, const std::uint8_t* row, const std::uint8_t* above,
                std::size_t size, std::uint8_t* to) {
    for (std::size_t i = 0; i < size; ++i) {
        const int left = i < channels ? 0 : row[i - channels];
        const int corner = i < channels ? 0 : above[i - channels];
        const int foretold = filter == 0   ? 0
                             : filter == 1 ? left
                             : filter == 2 ? above[i]
                             : filter == 3 ? (left + above[i]) / 2
                                           : paeth(left, above[i], corner);
        to[i] = static_cast<std::uint8_t>(row[i] - foretold);
    }
}

/// The usual measure of how well a row will compress: small differences of either sign.
std::uint64_t cost(std::span<const std::uint8_t> row) {
    std::uint64_t sum = 0;
    for (const std::uint8_t byte : row) {
        sum +=
            static_cast<std::uint64_t>(std::abs(static_cast<int>(static_cast<std::int8_t>(byte))));
    }
    return sum;
}

struct filtered_rows {
    bytes data; ///< each row after the number of its filter
    std::uint64_t cost = 0;
};

/// Each row by the filter that suits it.
filtered_rows filtered(const bytes& pixels, std::uint32_t width, std::uint32_t height) {
    const std::size_t size = channels * width;
    filtered_rows rows;
    rows.data.reserve((size + 1) * height);
    bytes above(size);
    bytes tried(size);
    bytes best(size);
    for (std::uint32_t y = 0; y < height; ++y) {
        const std::uint8_t* row = pixels.data() + size * y;
        std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
        std::uint8_t chosen = 0;
        for (std::uint8_t filter = 0; filter < 5; ++filter) {
            filter_row(filter, row, above.data(), size, tried.data());
            const std::uint64_t sum = cost(tried);
            if (sum < least) {
                least = sum;
                chosen = filter;
                best.swap(tried);
            }
        }
        rows.data.push_back(chosen);
        rows.data.insert(rows.data.end(), best.begin(), best.end());
        rows.cost += least;
        std::copy_n(row, size, above.begin());
    }
    return rows;
}

/// As a zlib stream, after the bytes that are in `to` already.
result<void> compress(const std::string& path, bytes& rows, bytes& to) {
    int size = 0;
    constexpr int quality = 8; // as stb's own PNG
    // Rows are 2³⁰ bytes and 16384 more at most, so that their number is an int.
    const std::unique_ptr<unsigned char, decltype(&std::free)> made(
        stbi_zlib_compress(rows.data(), static_cast<int>(rows.size()), &size, quality), &std::free);
    if (!made) {
        return fail(error_code::out_of_memory,
                    "There is not enough memory to compress " + in_quotes(path) + ".");
    }
    if (size < 0) {
        return fail(error_code::out_of_memory, in_quotes(path) + " would be too large.");
    }
    to.reserve(to.size() + static_cast<std::size_t>(size));
    for (int i = 0; i < size; ++i) { // in place of insert, where g++ 12 sees an overflow
        to.push_back(made.get()[i]);
    }
    return {};
}

constexpr std::uint8_t blend_source = 0;
constexpr std::uint8_t blend_over = 1;

bytes frame_control(std::uint32_t sequence, const rectangle& part, apng_delay delay,
                    std::uint8_t blend) {
    bytes control;
    for (const std::uint32_t value : {sequence, part.width, part.height, part.x, part.y}) {
        add_number(control, value, 4);
    }
    add_number(control, delay.numerator, 2);
    add_number(control, delay.denominator, 2);
    control.push_back(0); // leave the frame where it is
    control.push_back(blend);
    return control;
}

failure cannot(const std::string& path, const std::string& why) {
    return fail(error_code::bad_input, in_quotes(path) + " can't be written: " + why);
}

result<void> write_header(atomic_file& file, std::uint32_t width, std::uint32_t height,
                          std::uint32_t frames) {
    constexpr std::string_view signature = "\x89PNG\r\n\x1a\n";
    if (auto done = file.write(signature); !done) {
        return done;
    }
    bytes header;
    add_number(header, width, 4);
    add_number(header, height, 4);
    // Eight bits of red, green, blue and alpha; the only compression and filters; no interlacing.
    header.insert(header.end(), {8, 6, 0, 0, 0});
    if (auto done = write_chunk(file, "IHDR", header); !done) {
        return done;
    }
    bytes control;
    add_number(control, frames, 4);
    add_number(control, 0, 4); // play without end
    return write_chunk(file, "acTL", control);
}

} // namespace

apng_delay delay_of(double frames_per_second) {
    constexpr double most = 65535;
    const double rate =
        frames_per_second >= 1 / most ? std::min(frames_per_second, most) : 1 / most;
    apng_delay best;
    double least = std::numeric_limits<double>::max();
    for (std::uint32_t numerator = 1; numerator <= 65535 && least > 0; ++numerator) {
        const double denominator = std::round(numerator * rate);
        if (denominator < 1 || denominator > most) {
            continue;
        }
        // The smallest fraction of those that are the same but for rounding.
        const double error = std::abs(denominator / numerator - rate) / rate;
        if (error < least - 1e-12) {
            least = error;
            best = {static_cast<std::uint16_t>(numerator), static_cast<std::uint16_t>(denominator)};
        }
    }
    return best;
}

apng_writer::apng_writer(atomic_file file, std::string path, std::uint32_t width,
                         std::uint32_t height, std::uint32_t frames, apng_delay delay)
    : file_(std::move(file)), path_(std::move(path)), width_(width), height_(height),
      frames_(frames), delay_(delay) {}

result<apng_writer> apng_writer::create(const std::string& path, std::uint32_t width,
                                        std::uint32_t height, std::uint32_t frames,
                                        apng_delay delay) {
    constexpr std::uint32_t longest = 16384;
    constexpr std::uint32_t most_frames = 1u << 30u; // each has two numbers of 31 bits
    if (width == 0 || height == 0 || width > longest || height > longest) {
        return cannot(path, "a picture of " + std::to_string(width) + " x " +
                                std::to_string(height) + " pixels isn't possible.");
    }
    if (frames == 0 || frames > most_frames) {
        return cannot(path,
                      "an animation of " + std::to_string(frames) + " frames isn't possible.");
    }
    auto file = atomic_file::create(path);
    if (!file) {
        return failure(file.error());
    }
    if (auto done = write_header(*file, width, height, frames); !done) {
        return failure(done.error());
    }
    return apng_writer(std::move(*file), path, width, height, frames, delay);
}

result<void> apng_writer::add(std::span<const std::uint8_t> pixels) {
    if (pixels.size() != channels * width_ * height_) {
        return cannot(path_, "a frame of " + std::to_string(width_) + " x " +
                                 std::to_string(height_) + " pixels has no " +
                                 std::to_string(pixels.size()) + " bytes.");
    }
    if (added_ == frames_) {
        return cannot(path_, "there are more than " + std::to_string(frames_) + " frames.");
    }
    try {
        return write_frame(pixels);
    } catch (const std::exception&) { // bad_alloc
        return fail(error_code::out_of_memory,
                    "There is not enough memory to write " + in_quotes(path_) + ".");
    }
}

result<void> apng_writer::write_frame(std::span<const std::uint8_t> pixels) {
    const bool first = added_ == 0;
    rectangle part{0, 0, width_, height_};
    std::uint8_t blend = blend_source;
    if (!first) {
        part = changed_part(shown_, pixels, width_, height_);
    }
    bytes now = cut(pixels, width_, part);
    filtered_rows rows = filtered(now, part.width, part.height);
    if (!first && leave_out_same(cut(shown_, width_, part), now)) {
        filtered_rows over = filtered(now, part.width, part.height);
        if (over.cost < rows.cost) {
            rows = std::move(over);
            blend = blend_over;
        }
    }
    if (auto done = write_chunk(file_, "fcTL", frame_control(sequence_++, part, delay_, blend));
        !done) {
        return done;
    }
    bytes data;
    if (!first) {
        add_number(data, sequence_++, 4);
    }
    if (auto done = compress(path_, rows.data, data); !done) {
        return done;
    }
    if (auto done = first ? write_chunk(file_, "IDAT", data) : write_chunk(file_, "fdAT", data);
        !done) {
        return done;
    }
    shown_.assign(pixels.begin(), pixels.end());
    ++added_;
    return {};
}

result<void> apng_writer::commit() {
    if (added_ != frames_) {
        return cannot(path_, "there are " + std::to_string(added_) + " frames of " +
                                 std::to_string(frames_) + ".");
    }
    if (auto done = write_chunk(file_, "IEND", {}); !done) {
        return done;
    }
    return file_.commit();
}

} // namespace skybark::io
