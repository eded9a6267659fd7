#pragma once
// Where the CPU backend's kernels put their vertices.

#include <skybark/core/kernel.hpp>

#include <cstring>

#if defined(__SSE2__)
#    include <emmintrin.h>
#endif

namespace skybark::cpu {

/// Writes one vertex past the cache: what a mesher writes is read by somebody else, much later.
/// `to` is 16-byte aligned.
template <vertex_record Vertex>
void stream_vertex(std::byte* to, const Vertex& vertex) {
#if defined(__SSE2__)
    float words[sizeof(Vertex) / sizeof(float)];
    std::memcpy(words, &vertex, sizeof(Vertex));
    for (std::size_t i = 0; i < sizeof(Vertex) / 16; ++i) {
        _mm_stream_ps(reinterpret_cast<float*>(to) + 4 * i, _mm_loadu_ps(words + 4 * i));
    }
#else
    std::memcpy(to, &vertex, sizeof(Vertex));
#endif
}

/// The same for a multiple of 16 bytes. `from` is aligned, too.
inline void stream_bytes(std::byte* to, const std::byte* from, std::size_t bytes) {
#if defined(__SSE2__)
    for (std::size_t i = 0; i < bytes; i += 16) {
        _mm_stream_ps(reinterpret_cast<float*>(to + i),
                      _mm_load_ps(reinterpret_cast<const float*>(from + i)));
    }
#else
    std::memcpy(to, from, bytes);
#endif
}

/// Makes streamed vertices visible to other threads.
inline void finish_streaming() {
#if defined(__SSE2__)
    _mm_sfence();
#endif
}

/// Vertices one after another.
template <vertex_record Vertex>
struct vertex_sink {
    std::byte* to;

    void operator()(const Vertex& vertex) {
        stream_vertex(to, vertex);
        to += sizeof(Vertex);
    }
};

/// Turns the vertices of a strip into triangles of a list, as long as there is room.
template <vertex_record Vertex>
class triangle_sink {
  public:
    triangle_sink(std::byte* to, std::uint64_t room) : to_(to), room_(room) {}

    void begin_strip() { seen_ = 0; }

    void operator()(const Vertex& vertex) {
        if (seen_ >= 2) {
            const bool odd = seen_ % 2 == 1;
            triangle(odd ? newer_ : older_, odd ? older_ : newer_, vertex);
        }
        older_ = newer_;
        newer_ = vertex;
        ++seen_;
    }

    void degenerate(std::uint64_t triangles) {
        for (std::uint64_t i = 0; i < triangles; ++i) {
            triangle(Vertex{}, Vertex{}, Vertex{});
        }
    }

    /// Whole triangles may be written from `place` on, as long as there is `room`, past the sink.
    [[nodiscard]] std::byte* place() const { return to_; }
    [[nodiscard]] std::uint64_t room() const { return room_; }
    void skip(std::uint64_t triangles) {
        to_ += triangles * 3 * sizeof(Vertex);
        room_ -= triangles;
    }

  private:
    void triangle(const Vertex& a, const Vertex& b, const Vertex& c) {
        if (room_ == 0) {
            return;
        }
        --room_;
        for (const Vertex* vertex : {&a, &b, &c}) {
            stream_vertex(to_, *vertex);
            to_ += sizeof(Vertex);
        }
    }

    std::byte* to_;
    std::uint64_t room_;
    std::uint32_t seen_ = 0;
    Vertex older_;
    Vertex newer_;
};

} // namespace skybark::cpu
