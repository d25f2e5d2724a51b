#pragma once

namespace filasofia::sofaengine {

inline constexpr const char* kLacks = " is not available with the engine 'sofa'"; ///< how every refusal ends

} // namespace filasofia::sofaengine
