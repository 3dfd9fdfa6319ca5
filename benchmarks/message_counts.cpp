// Counts what a process of MPI sends and receives, for benchmarks/messages.py: a library that is loaded before the
// program (LD_PRELOAD), and takes the place of the calls that the program sends and receives with.
#include <mpi.h>

#include <cstdio>
#include <cstdlib>
#include <string>

namespace {

struct Counts {
  long long messages = 0, bytes = 0, largest = 0;
};
Counts sent, received;

void count(int numbers, MPI_Datatype type, Counts& counts) {
  int size = 0;
  PMPI_Type_size(type, &size);
  const long long own = static_cast<long long>(numbers) * size;
  ++counts.messages;
  counts.bytes += own;
  if (own > counts.largest) counts.largest = own;
}

}  // namespace

extern "C" {

int MPI_Send(const void* from, int numbers, MPI_Datatype type, int to, int tag, MPI_Comm group) {
  count(numbers, type, sent);
  return PMPI_Send(from, numbers, type, to, tag, group);
}

int MPI_Isend(const void* from, int numbers, MPI_Datatype type, int to, int tag, MPI_Comm group, MPI_Request* request) {
  count(numbers, type, sent);
  return PMPI_Isend(from, numbers, type, to, tag, group, request);
}

// The program asks how long a message is before it takes it, so that is its length.
int MPI_Recv(void* to, int numbers, MPI_Datatype type, int from, int tag, MPI_Comm group, MPI_Status* status) {
  count(numbers, type, received);
  return PMPI_Recv(to, numbers, type, from, tag, group, status);
}

int MPI_Finalize() {
  int rank = 0;
  PMPI_Comm_rank(MPI_COMM_WORLD, &rank);
  if (const char* const file = std::getenv("ABBE_MESSAGE_COUNTS")) {
    if (std::FILE* const out = std::fopen((std::string(file) + "." + std::to_string(rank)).c_str(), "w")) {
      for (const Counts& counts : {sent, received})
        std::fprintf(out, "%lld %lld %lld\n", counts.messages, counts.bytes, counts.largest);
      std::fclose(out);
    }
  }
  return PMPI_Finalize();
}

}  // extern "C"
