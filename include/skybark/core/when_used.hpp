#pragma once
// template <class = when_used>: a host function that costs only those who call it.

namespace skybark {

/// The default argument of a template that has no other:
///
///     template <class = when_used>
///     [[nodiscard]] result<skeleton> build_skeleton(std::span<const segment> segments);
///
/// is called like any function, yet the compiler makes its body, with the containers and algorithms
/// in it, only where somebody calls it. An `inline` function's it makes for everybody who includes
/// the header: most of what a builder costs. So host functions with more than arithmetic
/// in them, and classes made of such, are templates: over a backend, or over this.
struct when_used;

} // namespace skybark
