#pragma once
// How kernels on the CPU backend read and write volumes.

#include <skybark/cpu/half.hpp>
#include <skybark/cpu/memory.hpp>

#include <array>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace skybark::cpu {

/// The volumes of one call: a small value that kernels are given before their spans.
class grids {
  public:
    grids() = default;

    template <class B, names_volumes K>
    [[nodiscard]] static grids of(const volume_bindings<B, K>& volumes) {
        grids all;
        for (std::size_t i = 0; i < volumes.read.size(); ++i) {
            all.read_[i] = place::of(*volumes.read[i]);
        }
        for (std::size_t i = 0; i < volumes.write.size(); ++i) {
            all.write_[i] = place::of(*volumes.write[i]);
        }
        return all;
    }

    /// Of the n-th volume that is read.
    [[nodiscard]] glm::ivec3 size(std::uint32_t n) const { return read_[n].size; }

    /// A voxel inside of it.
    [[nodiscard]] float load(std::uint32_t n, glm::ivec3 at) const {
        const place& from = read_[n];
        return from.value(from.index(at.x, at.y, at.z));
    }

    /// Trilinear; 0 … 1 is edge to edge, beyond it the value at the edge. What is no number counts
    /// as 0.
    [[nodiscard]] float sample(std::uint32_t n, glm::vec3 at) const {
        const place& from = read_[n];
        const along x(at.x, from.size.x);
        const along y(at.y, from.size.y);
        const along z(at.z, from.size.z);
        const auto row = [&](int row_y, int row_z) {
            const std::size_t start = from.index(0, row_y, row_z);
            return x.between(from.value(start + static_cast<std::size_t>(x.low)),
                             from.value(start + static_cast<std::size_t>(x.high)));
        };
        return z.between(y.between(row(y.low, z.low), row(y.high, z.low)),
                         y.between(row(y.low, z.high), row(y.high, z.high)));
    }

    /// Writes a voxel of the n-th target, which is of float32.
    void store(std::uint32_t n, glm::ivec3 at, float value) const {
        const place& to = write_[n];
        std::memcpy(to.data + 4 * to.index(at.x, at.y, at.z), &value, sizeof value);
    }

    /// Where the voxels of a row along x lie in memory: of the n-th volume that is read, and of the
    /// n-th target. Floats, if the volume is of float32.
    [[nodiscard]] const std::byte* read_row(std::uint32_t n, int y, int z) const {
        return read_[n].data + bytes_per_voxel(read_[n].format) * read_[n].index(0, y, z);
    }
    [[nodiscard]] bool reads_floats(std::uint32_t n) const {
        return read_[n].format == volume_format::float32;
    }
    [[nodiscard]] std::byte* write_row(std::uint32_t n, int y, int z) const {
        return write_[n].data + 4 * write_[n].index(0, y, z);
    }

    // A fragment function reads its volumes under these names.
    [[nodiscard]] glm::ivec3 volume_size(std::uint32_t n) const { return size(n); }
    [[nodiscard]] float volume_load(std::uint32_t n, glm::ivec3 at) const { return load(n, at); }
    [[nodiscard]] float volume(std::uint32_t n, glm::vec3 at) const { return sample(n, at); }

  private:
    /// The two voxels that a coordinate lies between, and how far it is from the first.
    struct along {
        int low;
        int high;
        float part;

        along(float at, int size) {
            const float last = static_cast<float>(size - 1);
            const float cells = at * static_cast<float>(size) - 0.5f;
            // Both comparisons are false for NaN.
            const float inside = cells > 0.0f ? (cells < last ? cells : last) : 0.0f;
            low = static_cast<int>(inside);
            high = low + 1 < size ? low + 1 : low;
            part = inside - static_cast<float>(low);
        }
        [[nodiscard]] float between(float a, float b) const { return a * (1.0f - part) + b * part; }
    };

    struct place {
        std::byte* data = nullptr;
        glm::ivec3 size{0, 0, 0};
        volume_format format = volume_format::float32;

        [[nodiscard]] static place of(const cpu::volume& from) {
            const volume_description what = from.description();
            return {from.data(),
                    {static_cast<int>(what.width), static_cast<int>(what.height),
                     static_cast<int>(what.depth)},
                    what.format};
        }
        [[nodiscard]] std::size_t index(int x, int y, int z) const {
            return (static_cast<std::size_t>(z) * static_cast<std::size_t>(size.y) +
                    static_cast<std::size_t>(y)) *
                       static_cast<std::size_t>(size.x) +
                   static_cast<std::size_t>(x);
        }
        [[nodiscard]] float value(std::size_t i) const {
            switch (format) {
            case volume_format::float32: {
                float read = 0;
                std::memcpy(&read, data + 4 * i, sizeof read);
                return read;
            }
            case volume_format::float16: {
                half read;
                std::memcpy(&read, data + 2 * i, sizeof read);
                return to_float(read);
            }
            case volume_format::int32:
                break;
            }
            std::int32_t read = 0;
            std::memcpy(&read, data + 4 * i, sizeof read);
            return static_cast<float>(read);
        }
    };

    std::array<place, max_kernel_volumes> read_{};
    std::array<place, max_kernel_volumes> write_{};
};

} // namespace skybark::cpu
