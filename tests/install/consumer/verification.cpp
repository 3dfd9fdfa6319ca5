#include <abbe/study/verification.h>
#include <abbe/study/verification_text.h>

#include <cstdio>

int main(int /*argc*/, char** arguments) {
  abbe::VerificationRequest request = abbe::read_verification({.results = arguments[1]});
  request.least_reduction = 10;
  const abbe::Verification result = abbe::verify_compensation(request);
  std::fputs(abbe::verification_text(result).c_str(), stdout);
  return result.says_no() ? 1 : 0;
}
