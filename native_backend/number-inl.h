// The numbers that the chain kernel is written in: double, a SIMD pack of doubles (a gain a lane),
// and a dual number over either. Compiled once for every instruction set.

#if defined(NUNO_NUMBER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef NUNO_NUMBER_INL_H_
#undef NUNO_NUMBER_INL_H_
#else
#define NUNO_NUMBER_INL_H_
#endif

#include <hwy/highway.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace nuno::native {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// ---- double ---------------------------------------------------------------------------------

using Real = double;

#if HWY_NATIVE_FMA
HWY_INLINE Real mul_add(Real a, Real b, Real c) { return __builtin_fma(a, b, c); }
HWY_INLINE Real neg_mul_add(Real a, Real b, Real c) { return __builtin_fma(-a, b, c); }
#else
HWY_INLINE Real mul_add(Real a, Real b, Real c) { return a * b + c; }
HWY_INLINE Real neg_mul_add(Real a, Real b, Real c) { return c - a * b; }
#endif
HWY_INLINE Real absolute(Real a) {
  return std::bit_cast<Real>(std::bit_cast<std::uint64_t>(a) & ~(1ull << 63));
}
HWY_INLINE Real copy_sign(Real magnitude, Real sign) {
  constexpr std::uint64_t bit = 1ull << 63;
  return std::bit_cast<Real>((std::bit_cast<std::uint64_t>(magnitude) & ~bit) |
                             (std::bit_cast<std::uint64_t>(sign) & bit));
}
HWY_INLINE Real smaller(Real a, Real b) { return a < b ? a : b; }
HWY_INLINE Real larger(Real a, Real b) { return a > b ? a : b; }
/// a > b ? yes : no
HWY_INLINE Real where_greater(Real a, Real b, Real yes, Real no) { return a > b ? yes : no; }
HWY_INLINE Real rsqrt_guess(Real a) {
  return std::bit_cast<Real>(0x5FE6EB50C7B537A9ull - (std::bit_cast<std::uint64_t>(a) >> 1));
}

// ---- a pack of doubles ------------------------------------------------------------------------

struct Pack {
  using Tag = hn::ScalableTag<double>;
  hn::Vec<Tag> lanes;

  HWY_INLINE Pack() = default;
  HWY_INLINE Pack(hn::Vec<Tag> v) : lanes(v) {}
  HWY_INLINE Pack(double value) : lanes(hn::Set(Tag(), value)) {}
};

HWY_INLINE Pack operator+(Pack a, Pack b) { return hn::Add(a.lanes, b.lanes); }
HWY_INLINE Pack operator-(Pack a, Pack b) { return hn::Sub(a.lanes, b.lanes); }
HWY_INLINE Pack operator*(Pack a, Pack b) { return hn::Mul(a.lanes, b.lanes); }
HWY_INLINE Pack operator/(Pack a, Pack b) { return hn::Div(a.lanes, b.lanes); }
HWY_INLINE Pack mul_add(Pack a, Pack b, Pack c) { return hn::MulAdd(a.lanes, b.lanes, c.lanes); }
HWY_INLINE Pack neg_mul_add(Pack a, Pack b, Pack c) {
  return hn::NegMulAdd(a.lanes, b.lanes, c.lanes);
}
HWY_INLINE Pack absolute(Pack a) { return hn::Abs(a.lanes); }
HWY_INLINE Pack copy_sign(Pack magnitude, Pack sign) {
  return hn::CopySign(magnitude.lanes, sign.lanes);
}
HWY_INLINE Pack smaller(Pack a, Pack b) {
  return hn::IfThenElse(hn::Lt(a.lanes, b.lanes), a.lanes, b.lanes);
}
HWY_INLINE Pack larger(Pack a, Pack b) {
  return hn::IfThenElse(hn::Gt(a.lanes, b.lanes), a.lanes, b.lanes);
}
HWY_INLINE Pack where_greater(Pack a, Pack b, Pack yes, Pack no) {
  return hn::IfThenElse(hn::Gt(a.lanes, b.lanes), yes.lanes, no.lanes);
}
HWY_INLINE Pack rsqrt_guess(Pack a) {
  const hn::RebindToUnsigned<Pack::Tag> bits;
  const auto half = hn::ShiftRight<1>(hn::BitCast(bits, a.lanes));
  return hn::BitCast(Pack::Tag(), hn::Sub(hn::Set(bits, 0x5FE6EB50C7B537A9ull), half));
}

// ---- functions of either --------------------------------------------------------------------

/// a^(−1/2) for normal a > 0, to one unit in the last place or so: a guess from the bits of a
/// (3.4 % off) and four Newton steps, which cost a quarter of a square root and a division.
template <typename T>
HWY_INLINE T rsqrt(T a) {
  const T half = T(0.5) * a;
  T y = rsqrt_guess(a);
  y = y * neg_mul_add(half * y, y, T(1.5));
  y = y * neg_mul_add(half * y, y, T(1.5));
  y = y * neg_mul_add(half * y, y, T(1.5));
  const T residual = neg_mul_add(a * y, y, T(1.0));
  return mul_add(T(0.5) * y, residual, y);
}

/// asin(u) for 0 ≤ u ≤ √½ to 3.3e-14 of itself: u times a polynomial in u² that interpolates
/// asin(u)/u in the Chebyshev nodes of [0, ½].
template <typename T>
HWY_INLINE T asin_to_eighth_turn(T u) {
  static constexpr std::array<double, 15> k = {
      1.000000000000019,    0.16666666664942253, 0.0750000025617309,   0.04464270761074148,
      0.030386492943880166, 0.02228930662473215, 0.018331230484920864, 0.00610613520888045,
      0.05568476109393546,  -0.165715497454181,  0.5015922827940443,   -0.954813130798207,
      1.2533502320206436,   -0.9701727035341644, 0.3636759559627297};
  const T z = u * u;
  const T z2 = z * z;
  const T z4 = z2 * z2;
  const T z8 = z4 * z4;
  const auto pair = [&](int i) { return mul_add(T(k[i + 1]), z, T(k[i])); };
  const T a = mul_add(pair(2), z2, pair(0));
  const T b = mul_add(pair(6), z2, pair(4));
  const T c = mul_add(pair(10), z2, pair(8));
  const T d = mul_add(T(k[14]), z2, pair(12));
  return u * mul_add(mul_add(d, z4, c), z8, mul_add(b, z4, a));
}

/// The angle in [−π, π] of the unit vector (cosine, sine), without a division: asin of the smaller
/// component, turned into its quadrant.
template <typename T>
HWY_INLINE T angle(T sine, T cosine) {
  const T s = absolute(sine);
  const T c = absolute(cosine);
  const T folded = copy_sign(asin_to_eighth_turn(smaller(s, c)), cosine);
  const T steep = T(1.5707963267948966) - folded;
  const T flat = where_greater(T(0.0), cosine, T(3.141592653589793), T(0.0)) + folded;
  return copy_sign(where_greater(s, c, steep, flat), sine);
}

// ---- dual numbers ---------------------------------------------------------------------------

/// A value and its derivative with respect to one parameter.
template <typename T>
struct Dual {
  T value;
  T slope;

  HWY_INLINE Dual() = default;
  HWY_INLINE Dual(T v, T s) : value(v), slope(s) {}
};

template <typename T>
HWY_INLINE Dual<T> operator+(Dual<T> a, Dual<T> b) {
  return {a.value + b.value, a.slope + b.slope};
}
template <typename T>
HWY_INLINE Dual<T> operator-(Dual<T> a, Dual<T> b) {
  return {a.value - b.value, a.slope - b.slope};
}
template <typename T>
HWY_INLINE Dual<T> operator*(Dual<T> a, Dual<T> b) {
  return {a.value * b.value, mul_add(a.slope, b.value, a.value * b.slope)};
}
template <typename T>
HWY_INLINE Dual<T> mul_add(Dual<T> a, Dual<T> b, Dual<T> c) {
  return {mul_add(a.value, b.value, c.value),
          mul_add(a.slope, b.value, mul_add(a.value, b.slope, c.slope))};
}
template <typename T>
HWY_INLINE Dual<T> neg_mul_add(Dual<T> a, Dual<T> b, Dual<T> c) {
  return {neg_mul_add(a.value, b.value, c.value),
          neg_mul_add(a.slope, b.value, neg_mul_add(a.value, b.slope, c.slope))};
}

HWY_INLINE Real reciprocal(Real a) { return 1.0 / a; }
HWY_INLINE Pack reciprocal(Pack a) { return Pack(1.0) / a; }
template <typename T>
HWY_INLINE Dual<T> reciprocal(Dual<T> a) {
  const T value = reciprocal(a.value);
  return {value, (T(0.0) - value * value) * a.slope};
}
template <typename T>
HWY_INLINE Dual<T> rsqrt(Dual<T> a) {
  const T value = rsqrt(a.value);
  return {value, T(-0.5) * value * (value * value) * a.slope};
}
/// Of a unit vector: dθ = cosine·d(sine) − sine·d(cosine).
template <typename T>
HWY_INLINE Dual<T> angle(Dual<T> sine, Dual<T> cosine) {
  return {angle(sine.value, cosine.value),
          neg_mul_add(sine.value, cosine.slope, cosine.value * sine.slope)};
}

template <typename T>
HWY_INLINE T divide(T a, T b) {
  return a / b;
}
template <typename T>
HWY_INLINE Dual<T> divide(Dual<T> a, Dual<T> b) {
  return {a.value / b.value, a.slope / b.value};
}

// ---- constants times numbers ----------------------------------------------------------------

/// The number of type T with this value and no slope.
template <typename T>
struct Constant {
  static HWY_INLINE T of(double value) { return T(value); }
};
template <typename T>
struct Constant<Dual<T>> {
  static HWY_INLINE Dual<T> of(double value) { return {T(value), T(0.0)}; }
};

/// a·b + c with a constant a: no slope to carry.
template <typename T>
HWY_INLINE T scale_add(double a, T b, T c) {
  return mul_add(T(a), b, c);
}
template <typename T>
HWY_INLINE Dual<T> scale_add(double a, Dual<T> b, Dual<T> c) {
  return {mul_add(T(a), b.value, c.value), mul_add(T(a), b.slope, c.slope)};
}
template <typename T>
HWY_INLINE T scale(double a, T b) {
  return T(a) * b;
}
template <typename T>
HWY_INLINE Dual<T> scale(double a, Dual<T> b) {
  return {T(a) * b.value, T(a) * b.slope};
}
/// a + b with a constant a.
template <typename T>
HWY_INLINE T shift(double a, T b) {
  return T(a) + b;
}
template <typename T>
HWY_INLINE Dual<T> shift(double a, Dual<T> b) {
  return {T(a) + b.value, b.slope};
}

}  // namespace HWY_NAMESPACE
}  // namespace nuno::native
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
