# Declares a SPIR-V module, which the assembler embeds, to C++: cmake -DMODULE=<file> -DNAME=<array> -DOUTPUT=<file> -P declare_words.cmake
file(SIZE ${MODULE} bytes)
math(EXPR words "${bytes} / 4")
file(WRITE ${OUTPUT} "extern \"C\" [[gnu::visibility(\"hidden\")]] const uint32_t ${NAME}[${words}];\n")
