// Counts what a process of MPI sends, for benchmarks/messages.py: a library that is loaded before the program
// (LD_PRELOAD), and takes the place of the calls that the program sends with.
#include <mpi.h>

#include <cstdio>
#include <cstdlib>
#include <string>

namespace {

long long messages = 0, bytes = 0, largest = 0;

void count(int numbers, MPI_Datatype type) {
  int size = 0;
  PMPI_Type_size(type, &size);
  const long long own = static_cast<long long>(numbers) * size;
  ++messages;
  bytes += own;
  if (own > largest) largest = own;
}

}  // namespace

extern "C" {

int MPI_Send(const void* from, int numbers, MPI_Datatype type, int to, int tag, MPI_Comm group) {
  count(numbers, type);
  return PMPI_Send(from, numbers, type, to, tag, group);
}

int MPI_Isend(const void* from, int numbers, MPI_Datatype type, int to, int tag, MPI_Comm group, MPI_Request* request) {
  count(numbers, type);
  return PMPI_Isend(from, numbers, type, to, tag, group, request);
}

int MPI_Finalize() {
  int rank = 0;
  PMPI_Comm_rank(MPI_COMM_WORLD, &rank);
  if (const char* const file = std::getenv("ABBE_MESSAGE_COUNTS")) {
    if (std::FILE* const out = std::fopen((std::string(file) + "." + std::to_string(rank)).c_str(), "w")) {
      std::fprintf(out, "%lld %lld %lld\n", messages, bytes, largest);
      std::fclose(out);
    }
  }
  return PMPI_Finalize();
}

}  // extern "C"
