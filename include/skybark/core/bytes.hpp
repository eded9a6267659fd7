#pragma once
// Records in memory as bytes.
//
// The same as std::as_bytes of a span of the records; but for each type that a span is made of,
// compilers go through all that the standard asks of its iterators, which takes them as long as
// reading a header of this library.

#include <cstddef>
#include <span>
#include <vector>

namespace skybark {

template <class T>
[[nodiscard]] std::span<const std::byte> bytes_of(const std::vector<T>& records) {
    return {reinterpret_cast<const std::byte*>(records.data()), records.size() * sizeof(T)};
}
template <class T>
[[nodiscard]] std::span<const std::byte> bytes_of_one(const T& record) {
    return {reinterpret_cast<const std::byte*>(&record), sizeof(T)};
}
template <class T>
[[nodiscard]] std::span<std::byte> writable_bytes_of(std::vector<T>& records) {
    return {reinterpret_cast<std::byte*>(records.data()), records.size() * sizeof(T)};
}
/// From record `first` on.
template <class T>
[[nodiscard]] std::span<std::byte> writable_bytes_of(std::vector<T>& records, std::size_t first) {
    return {reinterpret_cast<std::byte*>(records.data() + first),
            (records.size() - first) * sizeof(T)};
}
template <class T>
[[nodiscard]] std::span<std::byte> writable_bytes_of_one(T& record) {
    return {reinterpret_cast<std::byte*>(&record), sizeof(T)};
}

} // namespace skybark
