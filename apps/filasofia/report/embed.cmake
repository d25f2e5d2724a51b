# Writes the C++ source OUTPUT: one function per file that returns its text (report_files.h). A missing file is empty.
# cmake -DOUTPUT=x.cpp -DNAMES="pageStyle;…" -DFILES="report.css;…" -P embed.cmake
set(code "// Made by embed.cmake.\n#include \"apps/filasofia/report_files.h\"\n\nnamespace filasofia::app {\nnamespace {\n")
set(functions)
foreach(name file IN ZIP_LISTS NAMES FILES)
  set(bytes "")
  if(EXISTS "${file}")
    file(READ "${file}" bytes HEX)
  endif()
  string(LENGTH "${bytes}" size)
  math(EXPR size "${size} / 2")
  string(REGEX REPLACE "(................................................................)" "\\1\n" bytes "${bytes}")
  # As numbers of char: a byte above 127 would be narrowed.
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "'\\\\x\\1'," bytes "${bytes}")
  string(APPEND code "const char ${name}Bytes[] = {\n${bytes}0};\n")
  string(APPEND functions "std::string_view ${name}() { return {${name}Bytes, ${size}}; }\n")
endforeach()
file(WRITE ${OUTPUT} "${code}} // namespace\n\n${functions}\n} // namespace filasofia::app\n")
