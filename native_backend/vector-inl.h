// Vectors in the plane of the numbers that the chain kernel is written in.

#if defined(NUNO_VECTOR_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef NUNO_VECTOR_INL_H_
#undef NUNO_VECTOR_INL_H_
#else
#define NUNO_VECTOR_INL_H_
#endif

#include <hwy/highway.h>
#include "number-inl.h"

HWY_BEFORE_NAMESPACE();
namespace nuno::native {
namespace HWY_NAMESPACE {

// For lambdas: compiled for the target and always inlined. One that GCC 12 leaves on its own, as it
// does in sanitized builds, finds its captures broken where the caller's stack is realigned for
// wide vectors.
#undef NUNO_INLINE_LAMBDA
#define NUNO_INLINE_LAMBDA __attribute__((always_inline)) HWY_ATTR

template <typename T>
struct Vec2 {
  T x, y;
};
template <typename T>
HWY_INLINE Vec2<T> operator+(Vec2<T> a, Vec2<T> b) {
  return {a.x + b.x, a.y + b.y};
}
template <typename T>
HWY_INLINE Vec2<T> operator-(Vec2<T> a, Vec2<T> b) {
  return {a.x - b.x, a.y - b.y};
}
template <typename T>
HWY_INLINE Vec2<T> operator*(T a, Vec2<T> b) {
  return {a * b.x, a * b.y};
}
template <typename T>
HWY_INLINE Vec2<T> scale(double a, Vec2<T> b) {
  return {scale(a, b.x), scale(a, b.y)};
}
template <typename T>
HWY_INLINE T dot(Vec2<T> a, Vec2<T> b) {
  return mul_add(a.x, b.x, a.y * b.y);
}
template <typename T>
HWY_INLINE T cross(Vec2<T> a, Vec2<T> b) {
  return neg_mul_add(a.y, b.x, a.x * b.y);
}

template <typename T>
HWY_INLINE auto value_of(Vec2<T> a) {
  return Vec2<decltype(value_of(a.x))>{value_of(a.x), value_of(a.y)};
}

/// Sums over the particles.
template <typename T>
struct Sums {
  Vec2<T> position;
  Vec2<T> velocity;  ///< only where control is damped
};

}  // namespace HWY_NAMESPACE
}  // namespace nuno::native
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
