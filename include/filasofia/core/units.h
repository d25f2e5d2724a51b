#pragma once

#include <numbers>

/// Units other than SI exist only as literals: 6_kPa and 6.0_kPa are the double 6000.
namespace filasofia::inline literals {

// clang-format off
constexpr double operator""_m(long double value) { return static_cast<double>(value); }
constexpr double operator""_m(unsigned long long value) { return static_cast<double>(value); }
constexpr double operator""_cm(long double value) { return static_cast<double>(value) * 1e-2; }
constexpr double operator""_cm(unsigned long long value) { return static_cast<double>(value) * 1e-2; }
constexpr double operator""_mm(long double value) { return static_cast<double>(value) * 1e-3; }
constexpr double operator""_mm(unsigned long long value) { return static_cast<double>(value) * 1e-3; }
constexpr double operator""_um(long double value) { return static_cast<double>(value) * 1e-6; }
constexpr double operator""_um(unsigned long long value) { return static_cast<double>(value) * 1e-6; }
constexpr double operator""_s(long double value) { return static_cast<double>(value); }
constexpr double operator""_s(unsigned long long value) { return static_cast<double>(value); }
constexpr double operator""_ms(long double value) { return static_cast<double>(value) * 1e-3; }
constexpr double operator""_ms(unsigned long long value) { return static_cast<double>(value) * 1e-3; }
constexpr double operator""_us(long double value) { return static_cast<double>(value) * 1e-6; }
constexpr double operator""_us(unsigned long long value) { return static_cast<double>(value) * 1e-6; }
constexpr double operator""_Hz(long double value) { return static_cast<double>(value); }
constexpr double operator""_Hz(unsigned long long value) { return static_cast<double>(value); }
constexpr double operator""_kHz(long double value) { return static_cast<double>(value) * 1e3; }
constexpr double operator""_kHz(unsigned long long value) { return static_cast<double>(value) * 1e3; }
constexpr double operator""_kg(long double value) { return static_cast<double>(value); }
constexpr double operator""_kg(unsigned long long value) { return static_cast<double>(value); }
constexpr double operator""_g(long double value) { return static_cast<double>(value) * 1e-3; }
constexpr double operator""_g(unsigned long long value) { return static_cast<double>(value) * 1e-3; }
constexpr double operator""_N(long double value) { return static_cast<double>(value); }
constexpr double operator""_N(unsigned long long value) { return static_cast<double>(value); }
constexpr double operator""_mN(long double value) { return static_cast<double>(value) * 1e-3; }
constexpr double operator""_mN(unsigned long long value) { return static_cast<double>(value) * 1e-3; }
constexpr double operator""_Pa(long double value) { return static_cast<double>(value); }
constexpr double operator""_Pa(unsigned long long value) { return static_cast<double>(value); }
constexpr double operator""_kPa(long double value) { return static_cast<double>(value) * 1e3; }
constexpr double operator""_kPa(unsigned long long value) { return static_cast<double>(value) * 1e3; }
constexpr double operator""_MPa(long double value) { return static_cast<double>(value) * 1e6; }
constexpr double operator""_MPa(unsigned long long value) { return static_cast<double>(value) * 1e6; }
constexpr double operator""_rad(long double value) { return static_cast<double>(value); }
constexpr double operator""_rad(unsigned long long value) { return static_cast<double>(value); }
constexpr double operator""_deg(long double value) { return static_cast<double>(value) * std::numbers::pi / 180.0; }
constexpr double operator""_deg(unsigned long long value) { return static_cast<double>(value) * std::numbers::pi / 180.0; }
} // namespace filasofia::inline literals
// clang-format on
