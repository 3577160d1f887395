// SPDX-License-Identifier: Apache-2.0
declare module "*?worker&inline" {
  const WorkerConstructor: new () => Worker;
  export default WorkerConstructor;
}
