#pragma once

namespace skyknot::inline SKYKNOT_ISA {

#if defined(__AVX512F__)
inline constexpr int native_width = 8;
#elif defined(__AVX__)
inline constexpr int native_width = 4;
#else
inline constexpr int native_width = 2;
#endif

}  // namespace skyknot::inline SKYKNOT_ISA
