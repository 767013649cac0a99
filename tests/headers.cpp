// An empty program, for the headers that all programs of tests share.
int main() {}
