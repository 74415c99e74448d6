// The numbers that the chain kernel is written in: double, a SIMD pack of doubles (a gain a lane),
// and a dual number over either. Compiled once for every instruction set.

#if defined(NUNO_NUMBER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef NUNO_NUMBER_INL_H_
#undef NUNO_NUMBER_INL_H_
#else
#define NUNO_NUMBER_INL_H_
#endif

#include <nuno/points.h>

#include <hwy/highway.h>

#include <array>
#include <bit>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace nuno::native {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// ---- double ---------------------------------------------------------------------------------

using Real = double;

constexpr std::uint64_t rsqrt_magic = 0x5FE166FEDC3018F1;

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
HWY_INLINE bool all_greater(Real a, Real b) { return a > b; }
/// From the bits of a: a^(−1/2) times 0.79 or so.
HWY_INLINE Real rsqrt_guess(Real a) {
  return std::bit_cast<Real>(rsqrt_magic - (std::bit_cast<std::uint64_t>(a) >> 1));
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
HWY_INLINE bool all_greater(Pack a, Pack b) {
  return hn::AllTrue(Pack::Tag(), hn::Gt(a.lanes, b.lanes));
}
HWY_INLINE Pack rsqrt_guess(Pack a) {
  const hn::RebindToUnsigned<Pack::Tag> bits;
  const auto half = hn::ShiftRight<1>(hn::BitCast(bits, a.lanes));
  return hn::BitCast(Pack::Tag(), hn::Sub(hn::Set(bits, rsqrt_magic), half));
}

// ---- functions of either --------------------------------------------------------------------

/// a^(−1/2) for normal a > 0, to 3e-12 of itself: a guess from the bits of a, a Newton step whose
/// constants make the most of it (8.8e-4 off), and the series of (1 − e)^(−1/2) to e³. It costs a
/// quarter of a square root and a division.
template <typename T>
HWY_INLINE T rsqrt(T a) {
  T y = rsqrt_guess(a);
  y = y * neg_mul_add(a * y, y, T(1.8909872833741173));
  const T e = neg_mul_add(a * y, y, T(1.0));
  const T series = mul_add(mul_add(T(0.3125), e, T(0.375)), e, T(0.5));
  return mul_add(y * e, series, y);
}

/// asin(u)/u as a polynomial in z = u² that interpolates it in the Chebyshev nodes of an interval.
/// For |u| ≤ 0.392, to 7e-12 of itself.
template <typename T>
HWY_INLINE T asin_of_small(T u) {
  static constexpr std::array<double, 7> k = {
      1.0000000000055052,   0.16666666315889284, 0.0750003629412287,  0.04462886848628869,
      0.030636106410950416, 0.02004589020856472, 0.027431490603941677};
  const T z = u * u;
  const T z2 = z * z;
  const auto pair = [&](int i) HWY_ATTR { return mul_add(T(k[i + 1]), z, T(k[i])); };
  return u * mul_add(mul_add(mul_add(T(k[6]), z2, pair(4)), z2, pair(2)), z2, pair(0));
}
/// For 0 ≤ u ≤ √½, to 9e-12 of itself.
template <typename T>
HWY_INLINE T asin_to_eighth_turn(T u) {
  static constexpr std::array<double, 12> k = {
      0.999999999994685,    0.16666666972322858,  0.07499971094054032,  0.044653488653867826,
      0.030181533475688627, 0.024579737152414304, 0.002128237218721364, 0.08190381809097139,
      -0.18557060941638176, 0.3718252429044575,   -0.3800978569568271,  0.20080490883347873};
  const T z = u * u;
  const T z2 = z * z;
  T sum = mul_add(T(k[11]), z, T(k[10]));
  for (int i = 8; i >= 0; i -= 2) sum = mul_add(sum, z2, mul_add(T(k[i + 1]), z, T(k[i])));
  return u * sum;
}

/// The angle in [−π, π] of the unit vector (cosine, sine), without a division: asin of the smaller
/// component, turned into its quadrant. Most hinges hardly turn: if no lane does, the sine's own
/// asin is enough.
template <typename T>
HWY_INLINE T angle(T sine, T cosine) {
  const T hardly(0.92);
  const T slight = asin_of_small(sine);
  if (all_greater(cosine, hardly)) [[likely]]
    return slight;
  const T s = absolute(sine);
  const T c = absolute(cosine);
  const T folded = copy_sign(asin_to_eighth_turn(smaller(s, c)), cosine);
  const T steep = T(1.5707963267948966) - folded;
  const T flat = where_greater(T(0.0), cosine, T(3.141592653589793), T(0.0)) + folded;
  const T any = copy_sign(where_greater(s, c, steep, flat), sine);
  return where_greater(cosine, hardly, slight, any);
}

// ---- two numbers side by side ---------------------------------------------------------------

/// Derivatives along two directions, which share the value's own arithmetic.
template <typename T>
struct Pair {
  T first;
  T second;

  HWY_INLINE Pair() = default;
  HWY_INLINE Pair(T a, T b) : first(a), second(b) {}
  HWY_INLINE Pair(double value) : first(value), second(value) {}
};

template <typename T>
HWY_INLINE Pair<T> operator+(Pair<T> a, Pair<T> b) {
  return {a.first + b.first, a.second + b.second};
}
template <typename T>
HWY_INLINE Pair<T> operator-(Pair<T> a, Pair<T> b) {
  return {a.first - b.first, a.second - b.second};
}
template <typename T>
HWY_INLINE Pair<T> operator*(Pair<T> a, Pair<T> b) {
  return {a.first * b.first, a.second * b.second};
}
template <typename T>
HWY_INLINE Pair<T> operator*(T a, Pair<T> b) {
  return {a * b.first, a * b.second};
}
template <typename T>
HWY_INLINE Pair<T> operator/(Pair<T> a, T b) {
  return {a.first / b, a.second / b};
}
template <typename T>
HWY_INLINE Pair<T> mul_add(T a, Pair<T> b, Pair<T> c) {
  return {mul_add(a, b.first, c.first), mul_add(a, b.second, c.second)};
}
template <typename T>
HWY_INLINE Pair<T> mul_add(Pair<T> a, T b, Pair<T> c) {
  return mul_add(b, a, c);
}
template <typename T>
HWY_INLINE Pair<T> neg_mul_add(T a, Pair<T> b, Pair<T> c) {
  return {neg_mul_add(a, b.first, c.first), neg_mul_add(a, b.second, c.second)};
}
template <typename T>
HWY_INLINE Pair<T> neg_mul_add(Pair<T> a, T b, Pair<T> c) {
  return neg_mul_add(b, a, c);
}

// ---- dual numbers ---------------------------------------------------------------------------

/// A value and its derivative with respect to one parameter, or to two where S is a Pair.
template <typename T, typename S = T>
struct Dual {
  T value;
  S derivative;

  HWY_INLINE Dual() = default;
  HWY_INLINE Dual(T v, S s) : value(v), derivative(s) {}
};

template <typename T, typename S>
HWY_INLINE Dual<T, S> operator+(Dual<T, S> a, Dual<T, S> b) {
  return {a.value + b.value, a.derivative + b.derivative};
}
template <typename T, typename S>
HWY_INLINE Dual<T, S> operator-(Dual<T, S> a, Dual<T, S> b) {
  return {a.value - b.value, a.derivative - b.derivative};
}
template <typename T, typename S>
HWY_INLINE Dual<T, S> operator*(Dual<T, S> a, Dual<T, S> b) {
  return {a.value * b.value, mul_add(a.derivative, b.value, a.value * b.derivative)};
}
template <typename T, typename S>
HWY_INLINE Dual<T, S> mul_add(Dual<T, S> a, Dual<T, S> b, Dual<T, S> c) {
  return {mul_add(a.value, b.value, c.value),
          mul_add(a.derivative, b.value, mul_add(a.value, b.derivative, c.derivative))};
}
template <typename T, typename S>
HWY_INLINE Dual<T, S> neg_mul_add(Dual<T, S> a, Dual<T, S> b, Dual<T, S> c) {
  return {neg_mul_add(a.value, b.value, c.value),
          neg_mul_add(a.derivative, b.value, neg_mul_add(a.value, b.derivative, c.derivative))};
}

template <typename T>
constexpr bool has_derivative = false;
template <typename T, typename S>
inline constexpr bool has_derivative<Dual<T, S>> = true;

template <typename T>
HWY_INLINE T value_of(T a) {
  return a;
}
template <typename T, typename S>
HWY_INLINE T value_of(Dual<T, S> a) {
  return a.value;
}

/// 1/(c − a·b) with a constant c.
template <typename T>
HWY_INLINE T reciprocal_of_difference(T c, T a, T b) {
  return T(1.0) / neg_mul_add(a, b, c);
}
template <typename T, typename S>
HWY_INLINE Dual<T, S> reciprocal_of_difference(T c, Dual<T, S> a, Dual<T, S> b) {
  const T value = reciprocal_of_difference(c, a.value, b.value);
  return {value, value * value * mul_add(a.derivative, b.value, a.value * b.derivative)};
}
template <typename T>
HWY_INLINE T reciprocal(T a) {
  return T(1.0) / a;
}
template <typename T, typename S>
HWY_INLINE Dual<T, S> reciprocal(Dual<T, S> a) {
  const T value = reciprocal(a.value);
  return {value, T(-1.0) * value * value * a.derivative};
}
template <typename T, typename S>
HWY_INLINE Dual<T, S> rsqrt(Dual<T, S> a) {
  const T value = rsqrt(a.value);
  return {value, T(-0.5) * value * (value * value) * a.derivative};
}
/// Of a unit vector: dθ = cosine·d(sine) − sine·d(cosine).
template <typename T, typename S>
HWY_INLINE Dual<T, S> angle(Dual<T, S> sine, Dual<T, S> cosine) {
  return {angle(sine.value, cosine.value),
          neg_mul_add(sine.value, cosine.derivative, cosine.value * sine.derivative)};
}

template <typename T>
HWY_INLINE T divide(T a, T b) {
  return a / b;
}
template <typename T, typename S>
HWY_INLINE Dual<T, S> divide(Dual<T, S> a, Dual<T, S> b) {
  return {a.value / b.value, a.derivative / b.value};
}

// ---- lanes --------------------------------------------------------------------------------------

HWY_INLINE Index lanes_of(Real) { return 1; }
HWY_INLINE Index lanes_of(Pack) { return static_cast<Index>(hn::Lanes(Pack::Tag())); }
HWY_INLINE Index lanes_of(Pair<Pack>) { return 2 * lanes_of(Pack()); }
template <typename T>
HWY_INLINE Index lanes_of(Dual<T>) {
  return lanes_of(T());
}
HWY_INLINE Real load_lanes(const double* values, Real) { return *values; }
HWY_INLINE Pack load_lanes(const double* values, Pack) { return hn::LoadU(Pack::Tag(), values); }
HWY_INLINE void store_lanes(Real number, double* values) { *values = number; }
HWY_INLINE void store_lanes(Pack number, double* values) {
  hn::StoreU(number.lanes, Pack::Tag(), values);
}
HWY_INLINE Pair<Pack> load_lanes(const double* values, Pair<Pack>) {
  return {load_lanes(values, Pack()), load_lanes(values + lanes_of(Pack()), Pack())};
}
HWY_INLINE void store_lanes(Pair<Pack> number, double* values) {
  store_lanes(number.first, values);
  store_lanes(number.second, values + lanes_of(Pack()));
}

// ---- constants times numbers ----------------------------------------------------------------

/// The number of type T with this value and no derivative.
template <typename T>
struct Constant {
  using Value = T;
  static HWY_INLINE T of(double value) { return T(value); }
};
template <typename T, typename S>
struct Constant<Dual<T, S>> {
  using Value = T;
  static HWY_INLINE Dual<T, S> of(double value) { return {T(value), S(0.0)}; }
};

/// a·b + c with a constant a: no derivative to carry.
template <typename T>
HWY_INLINE T scale_add(double a, T b, T c) {
  return mul_add(T(a), b, c);
}
template <typename T, typename S>
HWY_INLINE Dual<T, S> scale_add(double a, Dual<T, S> b, Dual<T, S> c) {
  return {mul_add(T(a), b.value, c.value), mul_add(T(a), b.derivative, c.derivative)};
}
template <typename T>
HWY_INLINE T scale(double a, T b) {
  return T(a) * b;
}
template <typename T, typename S>
HWY_INLINE Dual<T, S> scale(double a, Dual<T, S> b) {
  return {T(a) * b.value, T(a) * b.derivative};
}
// The same with constants that differ by lane.
HWY_INLINE Pack operator-(Pack a) { return hn::Neg(a.lanes); }
HWY_INLINE Pack scale_add(Pack a, Pack b, Pack c) { return mul_add(a, b, c); }
HWY_INLINE Pack scale(Pack a, Pack b) { return a * b; }
template <typename S>
HWY_INLINE Dual<Pack, S> scale_add(Pack a, Dual<Pack, S> b, Dual<Pack, S> c) {
  return {mul_add(a, b.value, c.value), mul_add(a, b.derivative, c.derivative)};
}
template <typename S>
HWY_INLINE Dual<Pack, S> scale(Pack a, Dual<Pack, S> b) {
  return {a * b.value, a * b.derivative};
}
/// a + b with a constant a.
template <typename T>
HWY_INLINE T shift(double a, T b) {
  return T(a) + b;
}
template <typename T, typename S>
HWY_INLINE Dual<T, S> shift(double a, Dual<T, S> b) {
  return {T(a) + b.value, b.derivative};
}

}  // namespace HWY_NAMESPACE
}  // namespace nuno::native
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
