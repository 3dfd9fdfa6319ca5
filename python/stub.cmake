# stub.cmake: what nanobind's stubgen writes, as type checkers want it in strict mode: cmake -DFROM=... -DTO=... -P stub.cmake
file(READ ${FROM} text)
string(REGEX REPLACE "os\\.PathLike([^[])" "os.PathLike[str]\\1" text "${text}")
file(WRITE ${TO} "${text}")
