/* Projects with packages of npm, each a folder in a folder for all of them. */
import {execFileSync, spawnSync} from 'node:child_process';
import {cpSync, existsSync, mkdirSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {dirname, join} from 'node:path';

export const TOOLS = ['typescript@7', 'esbuild@0.28', 'vite@8', 'webpack@5', 'webpack-cli@7', 'rollup@4', '@rollup/plugin-node-resolve@16'];
export const REACT = ['react@19', 'react-dom@19', '@types/react@19'];

/* `folder` is host/web of the build folder, `work` that of the projects. */
export const projectsIn = (work, folder) => {
  const at = (project, ...names) => join(work, project, ...names);
  const write = (project, name, text) => (mkdirSync(dirname(at(project, name)), {recursive: true}), writeFileSync(at(project, name), text));
  const tool = (name, project, ...options) => execFileSync(at('tools', 'node_modules/.bin', name), options, {cwd: at(project), stdio: 'pipe', encoding: 'utf8'});

  /* Installs what a project lacks.  Without an answer of the registry there is nothing to test. */
  const install = (project, names) => {
    if (names.every(name => existsSync(at(project, 'node_modules', name.replace(/@[^@]*$/, '')))))
      return;
    write(project, 'package.json', JSON.stringify({private: true, type: 'module'}));
    const {status, stderr} = spawnSync('npm', ['install', '--no-audit', '--no-fund', '--ignore-scripts', '--save-exact', ...names],
      {cwd: at(project), encoding: 'utf8', timeout: 300_000});
    if (status !== 0) {
      console.log(`1..0 # SKIP npm cannot install ${names.join(' ')}: ${(stderr || 'no answer').trim().split('\n')[0]}`);
      process.exit(0);
    }
  };

  /* Installs packages by project, and in each this one as it was built. */
  const installAll = packages => {
    const {files} = JSON.parse(readFileSync(join(folder, 'package.json')));
    for (const [project, names] of Object.entries(packages)) {
      install(project, names);
      rmSync(at(project, 'node_modules/gscl'), {recursive: true, force: true});
      for (const name of [...files, 'package.json'])
        cpSync(join(folder, name), at(project, 'node_modules/gscl', name));
    }
  };
  return {at, write, tool, installAll};
};
