/* The commands of gscl.  argv[0] is the name of the command.  Each returns the exit code of the program. */
#ifndef GSCL_TOOL_COMMAND_H
#define GSCL_TOOL_COMMAND_H

int command_encode(int argc, char **argv);
int command_decode(int argc, char **argv);
int command_info(int argc, char **argv);
int command_compare(int argc, char **argv);
int command_export(int argc, char **argv);
int command_pack(int argc, char **argv);
int command_draw(int argc, char **argv);
int command_devices(int argc, char **argv);
int command_bench(int argc, char **argv);
int command_tradeoff(int argc, char **argv);

#endif
