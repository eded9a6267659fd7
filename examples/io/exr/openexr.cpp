// EXR files, by OpenEXR.

#include <io/atomic_file.hpp>
#include <io/exr.hpp>
#include <io/text_input.hpp>

#include <array>
#include <cstring>
#include <exception>
#include <new>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfOutputFile.h>
#include <vector>

namespace skybark::io {

namespace {

/// The bytes of a file, in memory: the library goes back to fill in where its lines begin.
class memory_stream : public Imf::OStream {
  public:
    memory_stream() : Imf::OStream("memory") {}

    void write(const char bytes[], int count) override {
        const auto size = static_cast<std::size_t>(count);
        if (bytes_.size() < at_ + size) {
            bytes_.resize(at_ + size);
        }
        std::memcpy(bytes_.data() + at_, bytes, size);
        at_ += size;
    }
    std::uint64_t tellp() override { return at_; }
    void seekp(std::uint64_t position) override { at_ = static_cast<std::size_t>(position); }

    [[nodiscard]] std::string_view bytes() const { return bytes_; }

  private:
    std::string bytes_;
    std::size_t at_ = 0;
};

/// Whole rows from the top, in OpenEXR's own order: as the pixels come.
void encode(memory_stream& to, std::span<const glm::vec4> pixels, std::uint32_t width,
            std::uint32_t height) {
    Imf::Header header(static_cast<int>(width), static_cast<int>(height));
    header.compression() = Imf::ZIP_COMPRESSION;
    Imf::FrameBuffer frame;
    // The library takes what it only reads as char*.
    auto* const first = const_cast<char*>(reinterpret_cast<const char*>(pixels.data()));
    constexpr std::array<const char*, 4> names{"R", "G", "B", "A"};
    for (std::size_t c = 0; c < names.size(); ++c) {
        header.channels().insert(names[c], Imf::Channel(Imf::FLOAT));
        frame.insert(names[c], Imf::Slice(Imf::FLOAT, first + c * sizeof(float), sizeof(glm::vec4),
                                          sizeof(glm::vec4) * width));
    }
    Imf::OutputFile file(to, header);
    file.setFrameBuffer(frame);
    file.writePixels(static_cast<int>(height));
}

} // namespace

result<void> write_exr(const std::string& path, std::span<const glm::vec4> pixels,
                       std::uint32_t width, std::uint32_t height) {
    constexpr std::uint32_t longest = 65536;
    if (width == 0 || height == 0 || width > longest || height > longest ||
        pixels.size() != std::size_t{width} * height) {
        return fail(error_code::bad_input, in_quotes(path) + " can't be written: a picture of " +
                                               std::to_string(width) + " x " +
                                               std::to_string(height) + " pixels from " +
                                               std::to_string(pixels.size()) + " isn't possible.");
    }
    try {
        memory_stream stream;
        encode(stream, pixels, width, height);
        return write_file(path, stream.bytes());
    } catch (const std::bad_alloc&) {
        return fail(error_code::out_of_memory,
                    "There is not enough memory to compress " + in_quotes(path) + ".");
    } catch (const std::exception& e) {
        return fail(error_code::bad_input, in_quotes(path) + " can't be written: OpenEXR says " +
                                               in_quotes(e.what()) + ".");
    }
}

bool has_exr() { return true; }

} // namespace skybark::io
