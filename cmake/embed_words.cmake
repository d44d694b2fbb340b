# Writes a SPIR-V module as a C array: cmake -DMODULE=<file> -DNAME=<array> -DOUTPUT=<file> -P embed_words.cmake
file(READ ${MODULE} bytes HEX)
string(REGEX REPLACE "(..)(..)(..)(..)" "0x\\4\\3\\2\\1,\n" words "${bytes}")
file(WRITE ${OUTPUT} "const uint32_t ${NAME}[] = {\n${words}};\n")
