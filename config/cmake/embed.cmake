# cmake -DFOLDER=page -DINTO=page_files.cpp -P embed.cmake: the files of the live page as numbers in a source file.
set(text "// Made from ${FOLDER} at build time.\n#include \"pipeline/sinks/http/page_files.h\"\n\nnamespace eventide {\n\n")
foreach(pair "index.html:kPageHtml" "page.css:kPageCss" "page.js:kPageJs")
  string(REPLACE ":" ";" pair ${pair})
  list(GET pair 0 file)
  list(GET pair 1 name)
  file(READ ${FOLDER}/${file} hex HEX)
  string(REGEX REPLACE "(................................)" "\\1\n" hex "${hex}")
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "'\\\\x\\1'," bytes "${hex}")
  string(APPEND text "static const char ${name}Bytes[] = {\n${bytes}};\n"
    "const std::string_view ${name}{${name}Bytes, sizeof ${name}Bytes};\n\n")
endforeach()
file(WRITE ${INTO} "${text}}  // namespace eventide\n")
