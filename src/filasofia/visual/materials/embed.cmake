# Writes the bytes of INPUT into the C++ source OUTPUT as filasofia::visual::embedded::NAME.
file(READ ${INPUT} bytes HEX)
string(LENGTH "${bytes}" size)
math(EXPR size "${size} / 2")
string(REGEX REPLACE "(................................)" "\\1\n" bytes "${bytes}")
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
file(WRITE ${OUTPUT} "// Made by embed.cmake.
#include <cstddef>
#include <cstdint>
namespace filasofia::visual::embedded {
extern const std::uint8_t ${NAME}[];
extern const std::size_t ${NAME}Size;
const std::uint8_t ${NAME}[] = {
${bytes}};
const std::size_t ${NAME}Size = ${size};
} // namespace filasofia::visual::embedded
")
